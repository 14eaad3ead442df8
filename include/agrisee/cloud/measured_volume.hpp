// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The volume of a fruit whose shape is no ellipsoid, from where its surface was seen.
///
/// Fruit taper, have shoulders and dents; an ellipsoid that follows the seen side of such a body carries its slope on
/// to the unseen side and ends up too long. Here the surface is described by its distance from the center in every
/// direction. The logarithm of the distance is a Gaussian process over the sphere of directions with unknown mean
/// (kriging; Rasmussen & Williams, 2006, 2.2): it follows the points where there are any and returns to their mean
/// elsewhere. Metres, any frame. Cost: linear in the points, and a Cholesky factorisation with at most
/// DirectionBins::kCount unknowns.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/core/parameter_range.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <Eigen/Cholesky>

#include <array>
#include <optional>

namespace agrisee {

/// Parameters of measured_volume.
struct MeasuredVolumeParameters {
  double spread = 0.03;  ///< standard deviation of the radius over directions, relative to the fruit's mean
  double reach = 0.4;    ///< angle (rad) over which the radius is correlated
  double noise = 0.02;   ///< standard deviation of a point's radius, relative to it

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("spread", p.spread, Range::positive());
    f("reach", p.reach, Range::positive());
    f("noise", p.noise, Range::positive());
  }
};

namespace detail {

/// The points of a body in one bin of directions from its center.
struct VolumeBin {
  double count = 0.0;   ///< points
  double radius = 0.0;  ///< sum of their distances (m); then the logarithm of their mean
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< sum of their directions; then the mean direction, unit
};

/// The bins that have points, with logarithms of mean radii and with mean directions.
template <typename S>
std::vector<VolumeBin> volume_bins(const PointCloud<S>& cloud, const Indices& indices, const Eigen::Vector3d& center) {
  std::array<VolumeBin, DirectionBins::kCount> bins;
  for (Index i : indices) {
    const Eigen::Vector3d q = cloud.points[static_cast<std::size_t>(i)].template cast<double>() - center;
    const double r = q.norm();
    if (!(r > 1e-9) || !std::isfinite(r)) continue;
    VolumeBin& bin = bins[static_cast<std::size_t>(DirectionBins::bin(q))];
    bin.count += 1.0;
    bin.radius += r;
    bin.direction += q / r;
  }
  std::vector<VolumeBin> seen;
  for (VolumeBin bin : bins) {
    if (bin.count == 0.0) continue;
    bin.radius = std::log(bin.radius / bin.count);
    bin.direction.normalize();
    seen.push_back(bin);
  }
  return seen;
}

}  // namespace detail

/// Volume (m3) of a body from points on its surface. Any ray from the center is taken to leave the body once.
/// @param cloud points (m)
/// @param indices the points on the body's surface
/// @param center a point inside the body (m)
/// @param parameters see their struct
/// @return empty if there is no point away from the center
/// @throws ParameterError
template <typename S>
std::optional<double> measured_volume(const PointCloud<S>& cloud, const Indices& indices, const Eigen::Vector3d& center,
                                      const MeasuredVolumeParameters& parameters = {}) {
  parameters.check();
  const std::vector<detail::VolumeBin> seen = detail::volume_bins(cloud, indices, center);
  if (seen.empty()) return std::nullopt;
  double mean = 0.0;  // of the logarithms
  for (const detail::VolumeBin& bin : seen) mean += bin.radius;
  mean /= static_cast<double>(seen.size());

  // Covariance of the logarithms in two directions. The 1 that is added to all stands for the unknown mean.
  const double variance = parameters.spread * parameters.spread, narrow = 1.0 / (parameters.reach * parameters.reach);
  const auto covariance = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return 1.0 + variance * std::exp((a.dot(b) - 1.0) * narrow);
  };
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd K(n, n);
  Eigen::VectorXd weights(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const detail::VolumeBin& a = seen[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j <= i; ++j)
      K(i, j) = K(j, i) = covariance(a.direction, seen[static_cast<std::size_t>(j)].direction);
    // Errors of neighboring points are correlated: more than four of them count little.
    K(i, i) += parameters.noise * parameters.noise * (1.0 / std::min(4.0, a.count) + 0.04);
    weights[i] = a.radius - mean;
  }
  weights = Eigen::LLT<Eigen::MatrixXd>(K).solve(weights);
  double volume = 0.0;
  for (std::size_t b = 0; b < DirectionBins::kCount; ++b) {
    double logarithm = mean;
    for (Eigen::Index i = 0; i < n; ++i)
      logarithm += weights[i] * covariance(DirectionBins::directions()[b], seen[static_cast<std::size_t>(i)].direction);
    volume += DirectionBins::shares()[b] * std::exp(3.0 * logarithm);
  }
  return 4.0 / 3.0 * kPi * volume;
}

}  // namespace agrisee
