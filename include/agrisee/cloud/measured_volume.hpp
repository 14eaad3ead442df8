// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The volume of a fruit whose shape is no ellipsoid, from where its surface was seen.
///
/// Fruit taper, have shoulders and dents; an ellipsoid that follows the seen side of such a body carries its slope on
/// to the unseen side and ends up too long. Here the surface is taken as a distance from the centre for every
/// direction. The logarithm of the distance is a Gaussian process over the sphere of directions with unknown mean
/// (kriging; Rasmussen & Williams, 2006, 2.2): it follows the points where there are any and returns to their mean size
/// where there are none. Metres, any frame. Cost: linear in the points, and one factorisation of at most
/// DirectionBins::kCount unknowns.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <Eigen/Cholesky>

#include <array>
#include <optional>

namespace agrisee {

/// Parameters of measured_volume.
struct MeasuredVolumeParameters {
  double spread = 0.03;  ///< standard deviation of the radius over directions, relative to the fruit's mean
  double reach = 0.4;    ///< directions this far apart (rad) still know of each other
  double noise = 0.02;   ///< standard deviation of a point's radius, relative

  /// @throws ParameterError
  void check() const {
    check_parameter(spread > 0 && std::isfinite(spread), "measured_volume.spread", "positive", spread);
    check_parameter(reach > 0 && std::isfinite(reach), "measured_volume.reach", "positive", reach);
    check_parameter(noise > 0 && std::isfinite(noise), "measured_volume.noise", "positive", noise);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("spread", p.spread);
    f("reach", p.reach);
    f("noise", p.noise);
  }
};

/// Volume (m3) of a body with `center` (m) inside it, from its surface points `indices`; any ray from the centre is
/// taken to leave the body once. Empty when there is no point away from the centre.
/// @throws ParameterError
template <typename S>
std::optional<double> measured_volume(const PointCloud<S>& cloud, const Indices& indices, const Eigen::Vector3d& center,
                                      const MeasuredVolumeParameters& parameters = {}) {
  parameters.check();
  struct Bin {
    double count = 0.0, radius = 0.0;
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  };
  std::array<Bin, DirectionBins::kCount> bins;
  for (Index i : indices) {
    const Eigen::Vector3d q = cloud.points[static_cast<std::size_t>(i)].template cast<double>() - center;
    const double r = q.norm();
    if (!(r > 1e-9) || !std::isfinite(r)) continue;
    Bin& bin = bins[static_cast<std::size_t>(DirectionBins::bin(q))];
    bin.count += 1.0;
    bin.radius += r;
    bin.direction += q / r;
  }
  std::vector<Bin> seen;
  double mean = 0.0;  // of the logarithms
  for (Bin bin : bins) {
    if (bin.count == 0.0) continue;
    bin.radius = std::log(bin.radius / bin.count);
    bin.direction.normalize();
    mean += bin.radius;
    seen.push_back(bin);
  }
  if (seen.empty()) return std::nullopt;
  mean /= static_cast<double>(seen.size());

  // Covariances of the logarithms; the one added to all stands for a mean that is not known beforehand.
  const double variance = parameters.spread * parameters.spread, narrow = 1.0 / (parameters.reach * parameters.reach);
  const auto covariance = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return 1.0 + variance * std::exp((a.dot(b) - 1.0) * narrow);
  };
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd K(n, n);
  Eigen::VectorXd weights(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Bin& a = seen[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j <= i; ++j)
      K(i, j) = K(j, i) = covariance(a.direction, seen[static_cast<std::size_t>(j)].direction);
    K(i, i) += parameters.noise * parameters.noise * (1.0 / std::min(4.0, a.count) + 0.04);  // neighbours err together
    weights[i] = a.radius - mean;
  }
  weights = Eigen::LLT<Eigen::MatrixXd>(K).solve(weights);
  double volume = 0.0;
  for (std::size_t b = 0; b < bins.size(); ++b) {
    double logarithm = mean;
    for (Eigen::Index i = 0; i < n; ++i)
      logarithm += weights[i] * covariance(DirectionBins::directions()[b], seen[static_cast<std::size_t>(i)].direction);
    volume += DirectionBins::shares()[b] * std::exp(3.0 * logarithm);
  }
  return 4.0 / 3.0 * kPi * volume;
}

}  // namespace agrisee
