// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What closed surfaces of fruit look like: the harmonics of a body with a number of lobes, and how large each may be;
/// closed_surface.hpp says how the surface is described.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/geometry/spherical_harmonics.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace agrisee {

/// Parameters of closed_surface. Standard deviations are of the logarithm of the radius, that is, relative to it.
struct ClosedSurfaceParameters {
  double profile = 0.1;    ///< standard deviation of degree 2 of the profile; falls with degree^-1.5
  double lobes = 0.05;     ///< standard deviation of the lobes at their lowest degree; falls with 1 / degree
  double uneven = 0.0015;  ///< standard deviation of degree 2 of the asymmetric part; falls with 1 / degree
  double noise = 0.0025;   ///< least standard deviation of a point, relative to the radius
  double join = 0.035;     ///< unlabeled points this near to the surface, relative to the radius, join the fruit
  double doubtful = 50;    ///< up to this evidence (nats) against the ellipsoid, the ellipsoid is used
  double certain = 90;     ///< from this evidence on, the closed surface is used; in between a mixture
  double error_scale = 5;  ///< standard errors are this multiple of those for independent points
  int max_points = 1500;   ///< larger sets of points are thinned evenly to this many

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("profile", p.profile, Range::positive());
    f("lobes", p.lobes, Range::positive());
    f("uneven", p.uneven, Range::positive());
    f("noise", p.noise, Range::positive());
    f("join", p.join, Range::not_negative());
    f("doubtful", p.doubtful, Range::not_negative());
    f("certain", p.certain, Range::above({p.doubtful, "doubtful"}));
    f("error_scale", p.error_scale, Range::positive());
    f("max_points", p.max_points, Range::at_least(100));
  }
};

namespace detail {

/// Mean distances of points in bins of directions.
struct RadialBin {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< mean of its points, unit
  double logarithm = 0.0;                               ///< mean logarithm of their distances (of m)
  double weight = 0.0;                                  ///< sum of their weights
};

/// Variance of the mean logarithm of a bin's distances: errors of neighboring points are correlated.
/// @param weight sum of the weights of its points
/// @param noise standard deviation of a point, relative to the radius
inline double bin_variance(double weight, double noise) { return noise * noise * (1.0 / std::min(weight, 6.0) + 0.25); }

/// The harmonics of a body with some number of lobes (0: of revolution) and the variances of their coefficients.
struct SurfaceModel {
  SphericalHarmonics basis;
  Eigen::VectorXd prior;

  static constexpr int kProfile = 12;  ///< highest degree of the profile
  static constexpr int kUneven = 4;    ///< highest degree of what no symmetry explains

  static std::vector<int> top(int lobes) {
    std::vector<int> degrees(static_cast<std::size_t>(std::max(kUneven, 2 * lobes)) + 1, -1);
    degrees[0] = kProfile;
    for (std::size_t m = 1; m <= kUneven; ++m) degrees[m] = kUneven;
    if (lobes > 0) {
      const auto n = static_cast<std::size_t>(lobes);
      degrees[n] = std::max(10, lobes + 1);
      degrees[2 * n] = 2 * lobes + 2;
    }
    return degrees;
  }

  SurfaceModel(int lobes, const ClosedSurfaceParameters& parameters) : basis(top(lobes)), prior(basis.size()) {
    for (std::size_t k = 0; k < basis.size(); ++k) {
      const auto [l, m] = basis.terms()[k];
      const double degree = std::max(2, l);
      double deviation = 0.0;
      if (m == 0)
        deviation = l == 0 ? 2.0 : l == 1 ? 0.2 : parameters.profile * std::pow(2.0 / degree, 1.5);
      else if (l <= kUneven)
        deviation = parameters.uneven * 2.0 / degree;
      if (lobes > 0 && m == lobes) deviation = std::hypot(deviation, parameters.lobes * lobes / degree);
      if (lobes > 0 && m == 2 * lobes) deviation = std::hypot(deviation, 0.5 * parameters.lobes * lobes / degree);
      prior[static_cast<Eigen::Index>(k)] = deviation * deviation;
    }
  }
};

}  // namespace detail

}  // namespace agrisee
