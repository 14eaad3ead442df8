// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a fruit's calyx is: from the shape of its body, from what is seen of stem and calyx, and from gravity. Metres,
/// world frame. Cost: linear in the points.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/cloud.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace agrisee {

/// A line through a body's center that may be its growth axis.
struct BodyAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();       ///< unit; its sign means nothing
  double variance = std::numeric_limits<double>::infinity();  ///< of the direction (rad2), if it is the growth axis
  double ovality = 0.0;  ///< relative difference of the semi-axes across it, in its standard deviations: the fruit of
                         ///< one cultivar differ, and the fit errs
};

/// The semi-axes of a body, any of which may be its growth axis; those across the growth axis are nearly equal. None
/// for a sphere, and for a body whose covariance is not known.
inline std::vector<BodyAxis> body_axes(const EllipsoidFit& fit) {
  constexpr double kOvality = 0.05;  // standard deviation, among fruit
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(fit.body.A);
  const Eigen::Vector3d& inverse = solver.eigenvalues();  // inverse semi-axes, ascending
  if (!(inverse[2] - inverse[0] > 1e-9 * inverse[2]) || !(fit.shape_covariance.trace() > 0.0)) return {};
  const auto entry = [&](int i, int j) {  // of A between two of its axes, by the six of its numbers
    const Eigen::Vector3d u = solver.eigenvectors().col(i), v = solver.eigenvectors().col(j);
    Eigen::Matrix<double, 6, 1> out;
    out << u.x() * v.x(), u.y() * v.y(), u.z() * v.z(), u.x() * v.y() + u.y() * v.x(), u.x() * v.z() + u.z() * v.x(),
        u.y() * v.z() + u.z() * v.y();
    return out;
  };
  std::vector<BodyAxis> out(3);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    BodyAxis& axis = out[static_cast<std::size_t>(k)];
    axis.direction = solver.eigenvectors().col(k);
    axis.variance = 0.0;
    for (const int other : {i, j}) {  // an eigenvector turns towards another by their entry over the eigenvalues' gap
      const double gap = inverse[k] - inverse[other];
      axis.variance =
          std::max(axis.variance, entry(k, other).dot(fit.shape_covariance * entry(k, other)) / (gap * gap));
    }
    const double mean = 0.5 * (inverse[i] + inverse[j]);
    const auto difference = (entry(i, i) - entry(j, j)).eval();
    const double variance = kOvality * kOvality + difference.dot(fit.shape_covariance * difference) / (mean * mean);
    axis.ovality = std::abs(inverse[i] - inverse[j]) / (mean * std::sqrt(variance));
  }
  return out;
}

/// The direction from a fruit's center towards its calyx, by unlabeled points just outside the body (calyx, pedicel;
/// nearer ones weigh more) and, weakly, by gravity. Its length is the certainty of that direction, 1 / variance, in
/// `parameters.stem_certainty`.
/// @param cloud points (m, world)
/// @param labels one per point; 0: the point belongs to no fruit
/// @param body the fruit's body
/// @param parameters see their struct
template <typename S>
Eigen::Vector3d stem_direction(const PointCloud<S>& cloud, const Labels& labels, const Ellipsoid& body,
                               const GrowthAxisParameters& parameters = {}) {
  const double r = body.mean_radius();
  const double reach = semi_axes(body).first[0] + r;  // beyond the tips of a long fruit, too
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (labels[i] != 0) continue;
    const Eigen::Vector3d p = cloud.points[i].template cast<double>();
    if ((p - body.center).squaredNorm() > reach * reach) continue;
    const double d = body.distance(p);
    if (d < -0.3 * r || d > parameters.shell * r) continue;
    const double near = 1.0 - std::max(d, 0.0) / (parameters.shell * r);
    const Eigen::Vector3d u = (p - body.center).normalized();
    const double w = near * near * (1.0 + 0.8 * u.z());  // the stem of a hanging fruit is above it
    sum += w * u;
    weights += w;
  }
  Eigen::Vector3d out = parameters.up_weight * Eigen::Vector3d::UnitZ();
  if (weights > 0.0) out += std::min(1.0, weights / 10.0) * sum / weights;
  return out;
}

/// The direction from a fruit's center towards its calyx.
struct GrowthAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, world
  double variance = 0.5 * kPi * kPi - 2.0;               ///< of the direction (rad2); this one if it may be any
};

/// The growth axis of a fruit. Fruit are nearly round about it: of the body's axes the likeliest gives the line,
/// weighted by its certainty; `stem` gives its sense, tells between axes, and is the whole direction if the body has
/// none. What is known adds up as vectors as long as its certainty, so the variance is large where body and stem
/// disagree.
/// @param stem of stem_direction
/// @param axes that may be the growth axis
/// @param parameters see their struct
inline GrowthAxis growth_axis(const Eigen::Vector3d& stem, const std::vector<BodyAxis>& axes,
                              const GrowthAxisParameters& parameters = {}) {
  constexpr double kLeastVariance = 1e-3;  // rad2: no fruit's axis is known to better than 2 degrees
  constexpr double kWrong = 1.0;           // variance of the axis (rad2) if it is another one
  constexpr double kStemSurely = 0.25;     // of its weight: leaves and other stems look like the fruit's own
  const BodyAxis* best = nullptr;
  double most = 0.0, sum = 0.0;
  for (const BodyAxis& axis : axes) {
    const double likelihood = std::exp(parameters.stem_certainty * (std::abs(axis.direction.dot(stem)) - stem.norm()) -
                                       0.5 * axis.ovality * axis.ovality);
    sum += likelihood;
    if (best && !(likelihood > most)) continue;
    best = &axis;
    most = likelihood;
  }
  Eigen::Vector3d line = Eigen::Vector3d::Zero();
  if (best && std::isfinite(best->variance)) {
    const double variance = best->variance + (sum > 0.0 ? kWrong * (1.0 - most / sum) : kWrong);
    const double certainty = 1.0 / (std::max(variance, kLeastVariance) * parameters.stem_certainty);
    const double up = stem.norm() > 1e-9 ? best->direction.dot(stem) : best->direction.z();
    line = (up < 0.0 ? -certainty : certainty) * best->direction;
  }
  const Eigen::Vector3d known = stem + line, surely = kStemSurely * stem + line;
  GrowthAxis out;
  if (!(known.norm() > 1e-9)) return out;
  out.direction = known.normalized();
  out.variance = std::min(out.variance, 1.0 / (parameters.stem_certainty * surely.norm()));
  return out;
}

}  // namespace agrisee
