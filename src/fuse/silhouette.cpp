// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/fuse/silhouette.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace agrisee::fuse {
namespace {

using detail::Matrix9;
using detail::Vector9;

/// Residuals count up to this many standard deviations.
constexpr double kGate = 3.0;

/// A normal with which every body agrees: ellipsoid_row tests none.
constexpr double kAnyNormal = -2.0;

/// The point of a sight line that is nearest to the body's center in the body's metric: where it touches the body, if
/// it does.
Eigen::Vector3d touching_point(const Ellipsoid& body, const Eigen::Vector3d& sensor, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d a = body.times(ray), c = body.times(body.center - sensor);
  return sensor + ray * (a.dot(c) / a.squaredNorm());
}

/// The normal equations of one step, and how well the rays fit.
struct Sums {
  Matrix9 matrix = Matrix9::Zero();
  Vector9 rhs = Vector9::Zero();
  double weights = 0.0, squares = 0.0;
  std::size_t inliers = 0;
};

/// Add the sight lines along one outline.
void add_outline(const Silhouette& s, const Ellipsoid& body, double size, Sums& sums) {
  constexpr double kIndependent = 16.0;
  const double sigma = s.angle_error * (body.center - s.sensor).norm();
  Sums own;
  for (std::size_t i = 0; i < s.rays.size(); ++i) {
    const auto row = detail::ellipsoid_row(body, touching_point(body, s.sensor, s.rays[i]), Eigen::Vector3d::Zero(),
                                           size, kGate * sigma, kAnyNormal);
    const double weight = row.weight * s.weights[i];
    if (!(weight > 0.0)) continue;
    own.matrix.noalias() += weight * row.derivatives.lazyProduct(row.derivatives.transpose());
    own.rhs.noalias() -= weight * row.residual * row.derivatives;
    own.weights += weight;
    own.squares += weight * row.residual * row.residual;
    ++own.inliers;
  }
  if (!(own.weights > 0.0)) return;
  const double certainty = std::min(1.0, kIndependent * s.seen / own.weights) / (sigma * sigma);
  sums.matrix += certainty * own.matrix;
  sums.rhs += certainty * own.rhs;
  sums.weights += own.weights;
  sums.squares += own.squares;
  sums.inliers += own.inliers;
}

/// Add the mean distance of the points on one front, of those where the surface faces the sensor.
void add_front(const Silhouette& s, const Ellipsoid& body, double size, Sums& sums) {
  constexpr double kError = 0.004, kFacing = 0.7;
  const double sigma = kError * (body.center - s.sensor).norm();
  Vector9 derivatives = Vector9::Zero();
  double residual = 0.0, weights = 0.0;
  for (const Eigen::Vector3d& p : s.front) {
    const Eigen::Vector3d sight = (s.sensor - p).normalized();
    if (!(body.normal(p).dot(sight) > kFacing)) continue;
    const auto row = detail::ellipsoid_row(body, p, Eigen::Vector3d::Zero(), size, (kGate + 1.0) * sigma, kAnyNormal);
    if (!(row.weight > 0.0)) continue;  // its derivatives are not computed
    derivatives += row.weight * row.derivatives;
    residual += row.weight * row.residual;
    weights += row.weight;
  }
  if (!(weights > 0.0)) return;
  derivatives /= weights;
  sums.matrix.noalias() += derivatives * derivatives.transpose() / (sigma * sigma);
  sums.rhs.noalias() -= derivatives * (residual / weights) / (sigma * sigma);
}

/// Add that the harmonic mean of the semi-axes is expected to be a certain radius.
void add_expected(const SizePrior& expected, const Ellipsoid& body, double size, Sums& sums) {
  const double inverse = size / expected.radius, sigma = expected.spread * inverse;
  Vector9 derivatives = Vector9::Zero();
  derivatives.segment<3>(3).setConstant(1.0 / 3.0);
  const double residual = size * body.A.trace() / 3.0 - inverse;
  sums.matrix.noalias() += derivatives * derivatives.transpose() / (sigma * sigma);
  sums.rhs.noalias() -= derivatives * (residual / (sigma * sigma));
}

/// Add the prior on the shape, as detail::add_prior does, which see.
void add_shape(const Ellipsoid& body, double size, double shape_prior, Sums& sums) {
  detail::FitSums fit{sums.matrix, sums.rhs, 0.0, 0.0, 0};
  detail::add_prior(fit, body, size, 1.0, shape_prior);
  sums.matrix = fit.normal_matrix;
  sums.rhs = fit.rhs;
}

}  // namespace

std::optional<EllipsoidFit> fit_silhouettes(const std::vector<Silhouette>& outlines, const Ellipsoid& start,
                                            const std::optional<SizePrior>& expected, double shape_prior) {
  check_input(!outlines.empty(), "fit_silhouettes: there is no outline");
  constexpr int kIterations = 12;
  EllipsoidFit fit;
  fit.body = start;
  const double size = start.mean_radius();
  Matrix9 information = Matrix9::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    throw_if_cancelled();
    Sums sums;
    for (const Silhouette& s : outlines) {
      add_outline(s, fit.body, size, sums);
      add_front(s, fit.body, size, sums);
    }
    if (sums.inliers < 3) return std::nullopt;
    if (expected) add_expected(*expected, fit.body, size, sums);
    add_shape(fit.body, size, shape_prior, sums);
    const Vector9 step = Eigen::LDLT<Matrix9>(sums.matrix).solve(sums.rhs);
    const auto longest = detail::apply_step(fit.body, step, size);
    if (!longest) return std::nullopt;
    fit.inliers = sums.inliers;
    fit.rms = std::sqrt(sums.squares / sums.weights);
    information = sums.matrix;
    if (iteration > 3 && *longest < 1e-4) break;
  }
  const Matrix9 covariance = Eigen::LDLT<Matrix9>(information).solve(Matrix9::Identity());
  fit.center_covariance = covariance.topLeftCorner<3, 3>() * size * size;
  fit.shape_covariance = covariance.bottomRightCorner<6, 6>() / (size * size);
  return fit;
}

}  // namespace agrisee::fuse
