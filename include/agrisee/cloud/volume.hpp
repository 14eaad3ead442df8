// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Volume and mass of a fitted fruit with their standard errors, for estimates of yield.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/parameters.hpp>

namespace agrisee {

/// A value with its standard error.
struct Estimate {
  double value = 0.0;  ///< in its own unit
  double error = 0.0;  ///< standard error, in the same unit
};

/// Standard error of a volume, relative to it.
struct VolumeError {
  double total = 1.0;     ///< all of it
  double by_shape = 1.0;  ///< the part of it that is due to the unknown shape of the unseen side
};

/// Volume (m3) of an ellipsoid.
inline double volume(const Ellipsoid& body) { return 4.0 / 3.0 * kPi / body.A.determinant(); }

namespace detail {

/// Derivatives of the logarithm of det A, the inverse of the volume, by the unknowns of EllipsoidRow.
/// @param size the unknowns are scaled by this length (m)
inline Vector9 log_volume_gradient(const Ellipsoid& body, double size) {
  const Eigen::Matrix3d inverse = body.A.inverse() / size;
  return (Vector9() << 0.0, 0.0, 0.0, inverse(0, 0), inverse(1, 1), inverse(2, 2), 2.0 * inverse(0, 1),
          2.0 * inverse(0, 2), 2.0 * inverse(1, 2))
      .finished();
}

}  // namespace detail

/// Relative standard error of a fitted body's volume. This is the standard error of the logarithm of 1 / det A, whose
/// derivative by A is -A^-1, under the joint covariance of center and A. Points, derivatives, weights and prior are
/// those of fit_ellipsoid: the prior gives the uncertainty of the shape where there are no points. There is no prior
/// on the size, so too few points give a large error (at most 1). The noise is the larger of `noise` and
/// `sensor_noise`, also for small bodies, which the fit lets follow their points more closely. Points that fit_closely
/// leaves out count here, so the error is that of the wider fit.
/// @param cloud points (m) with normals
/// @param indices the points to which the body was fitted
/// @param body the fitted body
/// @param parameters those of the fit
/// @throws InputError if the cloud has no normals; ParameterError
template <typename S>
VolumeError relative_volume_error(const PointCloud<S>& cloud, const Indices& indices, const Ellipsoid& body,
                                  const FitParameters& parameters = {}) {
  parameters.check();
  check_input(cloud.normals.size() == cloud.points.size(), "relative_volume_error: the cloud has no normals");
  using detail::Matrix9, detail::Vector9;
  if (indices.empty()) return {};
  const std::size_t used = std::min(indices.size(), static_cast<std::size_t>(parameters.max_points));
  const double share = static_cast<double>(indices.size()) / static_cast<double>(used);
  const double size = body.mean_radius(), cos_max = std::cos(parameters.max_angle);
  const double noise = std::max(parameters.noise, parameters.sensor_noise);
  const double gate = std::max(parameters.gate * noise, 0.05 * size);
  Matrix9 information = Matrix9::Zero();
  double weights = 0.0;
  for (std::size_t k = 0; k < used; ++k) {
    const auto i = static_cast<std::size_t>(indices[k * indices.size() / used]);
    const auto row = detail::ellipsoid_row(body, cloud.points[i].template cast<double>(),
                                           cloud.normals[i].template cast<double>(), size, gate, cos_max);
    if (!(row.weight > 0.0)) continue;
    information.noalias() += (row.weight * row.derivatives).lazyProduct(row.derivatives.transpose());
    weights += row.weight;
  }
  if (!(weights > 0.0)) return {};
  information *= std::min(share, parameters.independent / weights) / (noise * noise);
  const Matrix9 prior = detail::shape_information(body, size, parameters.shape_prior);
  information += prior;
  information.diagonal().array() += 1e-9 * information.diagonal().maxCoeff();
  const Vector9 gradient = detail::log_volume_gradient(body, size);
  const Vector9 spread = Eigen::LDLT<Matrix9>(information).solve(gradient);
  const double variance = gradient.dot(spread);
  if (!(variance > 0.0) || !(variance < 1.0)) return {};
  return {std::sqrt(variance), std::sqrt(spread.dot(prior * spread))};
}

/// Volume (m3) of a fitted body. Its standard error combines that of the fit and the deviation of real fruit from an
/// ellipsoid (MassParameters::shape_error).
/// @param body the fitted body
/// @param relative_fit_error see relative_volume_error
/// @param parameters see their struct
inline Estimate volume_of(const Ellipsoid& body, double relative_fit_error, const MassParameters& parameters = {}) {
  const double v = volume(body);
  return {v, v * std::hypot(relative_fit_error, parameters.shape_error)};
}

/// Mass (kg) of a volume (m3). Its standard error combines those of the volume and of the density.
inline Estimate mass_of(const Estimate& volume, const MassParameters& parameters = {}) {
  return {parameters.density * volume.value,
          std::hypot(parameters.density * volume.error, parameters.density_error * volume.value)};
}

}  // namespace agrisee
