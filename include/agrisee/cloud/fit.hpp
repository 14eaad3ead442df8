// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fits spheres and ellipsoids to points with normals, robustly.
///
/// The fit is by Gauss-Newton with Tukey's biweight. A prior pulls the shape towards a sphere as far as the points
/// leave it open: of a fruit seen only as a crescent the fit gives a sphere, of one seen all around its own shape.
/// Metres. Cost: linear in the points per iteration.
#pragma once

#include <agrisee/cloud/body_shape.hpp>
#include <agrisee/cloud/ellipsoid_rows.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace agrisee {

/// What is known of a body's size before its points are looked at: the logarithm of its mean radius is normally
/// distributed.
struct SizePrior {
  double radius = 0.0;  ///< median of the mean radius (m)
  double spread = 0.0;  ///< standard deviation of its logarithm
};

/// The result of a fit.
struct EllipsoidFit {
  Ellipsoid body;                                                        ///< the fitted ellipsoid
  Eigen::Matrix3d center_covariance = Eigen::Matrix3d::Zero();           ///< covariance of body.center (m2)
  Eigen::Matrix3d center_covariance_by_shape = Eigen::Matrix3d::Zero();  ///< the part of it that the prior causes (m2)
  /// Covariance of body.A as (xx, yy, zz, xy, xz, yz) (1/m2), with the prior on its shape.
  Matrix6 shape_covariance = Matrix6::Zero();
  double rms = 0.0;                          ///< root mean square distance of the inliers (m)
  std::size_t inliers = 0;                   ///< points within three standard deviations whose normals agree
  std::optional<SizePrior> size_prior = {};  ///< what is known of its size, from other fruit
};

/// The sphere through points with outward normals: p = c + r n is linear in c and r, so r is the slope of the
/// regression of points on normals. Empty for fewer than 4 points, or if their normals hardly differ.
template <typename S>
std::optional<Sphere> sphere_from_normals(const PointCloud<S>& cloud, const Indices& indices) {
  if (indices.size() < 4) return std::nullopt;
  Eigen::Vector3d p_mean = Eigen::Vector3d::Zero(), n_mean = Eigen::Vector3d::Zero();
  for (Index i : indices) {
    p_mean += cloud.points[static_cast<std::size_t>(i)].template cast<double>();
    n_mean += cloud.normals[static_cast<std::size_t>(i)].template cast<double>();
  }
  const auto n = static_cast<double>(indices.size());
  p_mean /= n;
  n_mean /= n;
  double pn = 0.0, nn = 0.0;
  for (Index i : indices) {
    const Eigen::Vector3d dn = cloud.normals[static_cast<std::size_t>(i)].template cast<double>() - n_mean;
    pn += dn.dot(cloud.points[static_cast<std::size_t>(i)].template cast<double>() - p_mean);
    nn += dn.squaredNorm();
  }
  if (!(nn > 1e-6 * n)) return std::nullopt;
  const double r = pn / nn;
  return Sphere{p_mean - r * n_mean, r};
}

namespace detail {

/// Information matrix of the prior that size * A is close to a multiple of the identity (its deviatoric part is small).
/// @param axis of a long body (unit), along which it may be of any length; usually none
inline Matrix9 shape_information(const Ellipsoid& body, double size, double shape_prior,
                                 const std::optional<Eigen::Vector3d>& axis = {}) {
  const double relative = body.A.trace() * size / 3.0;  // mean of the inverse semi-axes, in units of 1 / size
  Matrix9 prior = Matrix9::Zero();
  prior.block<3, 3>(3, 3) = Eigen::Matrix3d::Identity() - Eigen::Matrix3d::Constant(1.0 / 3.0);
  prior.diagonal().tail<3>().setConstant(2.0);
  if (axis) {
    const Eigen::Vector3d& u = *axis;
    Vector9 length;
    length << 0, 0, 0, u.x() * u.x(), u.y() * u.y(), u.z() * u.z(), u.x() * u.y(), u.x() * u.z(), u.y() * u.z();
    const Vector9 known = prior * length;
    prior -= known * known.transpose() / length.dot(known);
  }
  prior /= shape_prior * shape_prior * relative * relative;
  return prior;
}

/// Row of the prior on the size: derivatives of the mean inverse semi-axis, in units of 1 / size.
inline Vector9 size_row() { return (Vector9() << 0, 0, 0, 1, 1, 1, 0, 0, 0).finished() / 3.0; }

/// Information of the prior on the mean inverse semi-axis, in units of 1 / size.
inline double size_information(const SizePrior& prior, double size) {
  return std::pow(prior.radius / (prior.spread * size), 2);
}

/// A point and its normal.
struct FitSample {
  Eigen::Vector3d point, normal;
};

/// `used` of the points `indices`, evenly picked.
template <typename S>
std::vector<FitSample> fit_samples(const PointCloud<S>& cloud, const Indices& indices, std::size_t used) {
  std::vector<FitSample> samples(used);
  for (std::size_t k = 0; k < used; ++k) {
    const auto i = static_cast<std::size_t>(indices[k * indices.size() / used]);
    samples[k] = {cloud.points[i].template cast<double>(), cloud.normals[i].template cast<double>()};
  }
  return samples;
}

/// Sums over the samples for one step.
struct FitSums {
  Matrix9 normal_matrix;    ///< of the weighted derivatives
  Vector9 rhs;              ///< right-hand side of the normal equations
  double weights = 0.0;     ///< sum of the weights
  double squares = 0.0;     ///< sum of the inliers' squared residuals (m2)
  std::size_t inliers = 0;  ///< samples close to the body
};

/// The sums, of several samples at once, so that the compiler can use vector instructions.
/// @tparam S number type of the terms; for points of single precision single precision is enough
/// @param gate as of ellipsoid_row (m)
/// @param inlier samples with smaller residuals (m) are inliers
/// @throws Cancelled
template <typename S>
FitSums fit_sums(const std::vector<FitSample>& samples, const Ellipsoid& body, double size, double gate, double cos_max,
                 double inlier) {
  constexpr std::size_t kLanes = 8, kTerms = 10;  // the tenth term of a row is the residual
  constexpr double kAtCenter = 1e-9;              // m; samples at the center have no direction
  constexpr double kFarthest = 1000.0;            // m; stands for samples that do not count
  using Lanes = Eigen::Array<S, int{kLanes}, 1>;
  std::array<Lanes, kTerms*(kTerms + 1) / 2> products;  // the upper triangle, row by row
  products.fill(Lanes::Zero());
  Lanes weights = Lanes::Zero(), squares = Lanes::Zero(), inliers = Lanes::Zero();
  for (std::size_t from = 0; from < samples.size(); from += kLanes) {
    if ((from & 0xFFF) == 0) throw_if_cancelled();
    Eigen::Array<S, int{kLanes}, 6> block = Eigen::Array<S, int{kLanes}, 6>::Constant(static_cast<S>(kFarthest));
    for (std::size_t i = from; i < std::min(from + kLanes, samples.size()); ++i) {
      const Eigen::Vector3d p = samples[i].point - body.center;
      if (p.squaredNorm() > kAtCenter * kAtCenter && p.squaredNorm() < kFarthest * kFarthest)
        block.row(static_cast<Eigen::Index>(i - from)) << p.transpose().array().template cast<S>(),
            samples[i].normal.transpose().array().template cast<S>();
    }
    const RowTerms<Lanes> terms = row_terms<Lanes, S>(body, block.col(0), block.col(1), block.col(2), block.col(3),
                                                      block.col(4), block.col(5), size);
    const Lanes weight = row_weight(terms, gate, cos_max);
    for (std::size_t a = 0, k = 0; a < kTerms; ++a) {
      const Lanes weighted = weight * terms[a];
      for (std::size_t b = a; b < kTerms; ++b, ++k) products[k] += weighted * terms[b];
    }
    const auto is_inlier = (weight > S(0) && terms.residual.abs() < static_cast<S>(inlier)).eval();
    weights += weight;
    inliers += is_inlier.template cast<S>();
    squares += is_inlier.select(terms.residual.square(), S(0));
  }
  Eigen::Matrix<double, int{kTerms}, int{kTerms}> sums;
  for (std::size_t a = 0, k = 0; a < kTerms; ++a)
    for (std::size_t b = a; b < kTerms; ++b, ++k) {
      const auto i = static_cast<Eigen::Index>(a), j = static_cast<Eigen::Index>(b);
      sums(i, j) = sums(j, i) = products[k].template cast<double>().sum();
    }
  return {sums.topLeftCorner<9, 9>(), -sums.topRightCorner<9, 1>(), weights.template cast<double>().sum(),
          squares.template cast<double>().sum(), static_cast<std::size_t>(inliers.sum())};
}

/// Multiply the normal equations by the samples' information and add the priors on the shape and, if there is one, on
/// the size.
/// @param certainty information of one sample of full weight (1/m2)
inline void add_prior(FitSums& sums, const Ellipsoid& body, double size, double certainty, double shape_prior,
                      const std::optional<SizePrior>& size_prior = {},
                      const std::optional<Eigen::Vector3d>& axis = {}) {
  sums.normal_matrix *= certainty;
  sums.rhs *= certainty;
  const Eigen::Matrix3d B = body.A * size - Eigen::Matrix3d::Identity();
  const Matrix9 prior = shape_information(body, size, shape_prior, axis);
  Vector9 b = Vector9::Zero();
  b.tail<6>() << B(0, 0), B(1, 1), B(2, 2), B(0, 1), B(0, 2), B(1, 2);
  sums.rhs -= prior * b;
  sums.normal_matrix += prior;
  if (size_prior) {
    const Vector9 row = size_row();
    const double information = size_information(*size_prior, size);
    sums.normal_matrix += (information * row).lazyProduct(row.transpose());
    sums.rhs -= information * (size / body.mean_radius() - size / size_prior->radius) * row;
  }
  sums.normal_matrix.diagonal().array() += 1e-9 * sums.normal_matrix.diagonal().maxCoeff();
}

/// Apply a step to a body; longer ones than 0.3 of its size are shortened to that.
/// @param step change of the center / size and of size * A as (xx, yy, zz, xy, xz, yz)
/// @return the length of the step, in units of the size, before it is shortened; empty if the body degenerates
inline std::optional<double> apply_step(Ellipsoid& body, const Vector9& step, double size) {
  if (!step.allFinite()) return std::nullopt;
  const double longest = std::max(step.head<3>().norm(), step.tail<6>().cwiseAbs().maxCoeff());
  const double damp = longest > 0.3 ? 0.3 / longest : 1.0;
  body.center += damp * size * step.head<3>();
  Eigen::Matrix3d dA;
  dA << step[3], step[6], step[7], step[6], step[4], step[8], step[7], step[8], step[5];
  body.A += damp * dA / size;
  const Eigen::Vector3d inverse_axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(body.A).eigenvalues();
  if (!(inverse_axes[0] > 0.2 / size) || !(inverse_axes[2] < 5.0 / size)) return std::nullopt;
  return longest;
}

}  // namespace detail

/// Fit an ellipsoid to the points `indices` of a cloud with normals, starting from `start`.
///
/// @param size_prior what is known of its size, which decides as far as the points leave it open; usually nothing
/// @param axis of a long body (unit): it is as round about it as others are in all directions, and of any length
/// @return empty if fewer than `parameters.independent / 10 + 4` points support the body or the fit degenerates
/// @throws InputError if the cloud has no normals; ParameterError
template <typename S>
std::optional<EllipsoidFit> fit_ellipsoid(const PointCloud<S>& cloud, const Indices& indices, const Ellipsoid& start,
                                          const FitParameters& parameters = {},
                                          const std::optional<SizePrior>& size_prior = {},
                                          const std::optional<Eigen::Vector3d>& axis = {}) {
  parameters.check();
  check_input(cloud.normals.size() == cloud.points.size(), "fit_ellipsoid: the cloud has no normals");
  const std::size_t least = static_cast<std::size_t>(parameters.independent / 10 + 4);
  if (indices.size() < least) return std::nullopt;
  const double cos_max = std::cos(parameters.max_angle);
  const std::size_t used = std::min(indices.size(), std::max(least, static_cast<std::size_t>(parameters.max_points)));
  const std::vector<detail::FitSample> samples = detail::fit_samples(cloud, indices, used);
  const double share = static_cast<double>(indices.size()) / static_cast<double>(used);  // points a sample stands for

  // Unknowns: the center in units of `size`, and B = A * size - I as (xx, yy, zz, xy, xz, yz).
  EllipsoidFit fit;
  fit.body = start;
  fit.size_prior = size_prior;
  const double size = start.mean_radius();
  const double noise = parameters.noise_of(size);
  const double inlier = 3.0 * std::max(noise, 0.01 * size);
  double gate = std::max(6.0 * noise, 0.12 * size);
  detail::Matrix9 information = detail::Matrix9::Zero();  // of the last step
  for (int iteration = 0; iteration < parameters.iterations; ++iteration) {
    detail::FitSums sums = detail::fit_sums<S>(samples, fit.body, size, gate, cos_max, inlier);
    if (share * sums.weights < 0.3 * static_cast<double>(least)) return std::nullopt;
    const double certainty = std::min(share, parameters.independent / sums.weights) / (noise * noise);
    detail::add_prior(sums, fit.body, size, certainty, parameters.shape_prior, size_prior, axis);
    const detail::Vector9 step = Eigen::LDLT<detail::Matrix9>(sums.normal_matrix).solve(sums.rhs);
    const auto longest = detail::apply_step(fit.body, step, size);
    if (!longest) return std::nullopt;
    fit.inliers = static_cast<std::size_t>(share * static_cast<double>(sums.inliers));
    fit.rms = sums.inliers ? std::sqrt(sums.squares / static_cast<double>(sums.inliers)) : 0.0;
    information = sums.normal_matrix;
    gate = std::max(0.7 * gate, parameters.gate_of(size));
    if (iteration > 3 && *longest < 1e-4) break;
  }
  if (fit.inliers < least / 2) return std::nullopt;
  const detail::Matrix9 covariance = Eigen::LDLT<detail::Matrix9>(information).solve(detail::Matrix9::Identity());
  fit.center_covariance = covariance.topLeftCorner<3, 3>() * size * size;
  const Eigen::Matrix<double, 3, 9> center = covariance.topRows<3>();
  detail::Matrix9 prior = detail::shape_information(fit.body, size, parameters.shape_prior, axis);
  if (size_prior)
    prior +=
        detail::size_information(*size_prior, size) * detail::size_row().lazyProduct(detail::size_row().transpose());
  fit.center_covariance_by_shape = center * prior * center.transpose() * size * size;
  fit.shape_covariance = covariance.bottomRightCorner<6, 6>() / (size * size);
  return fit;
}

}  // namespace agrisee
