// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Principal axes of small sets of points: the basis of normals, curvatures and frontier frames.
#pragma once

#include <agrisee/core/traits.hpp>

#include <Eigen/Eigenvalues>

namespace agrisee {

/// Mean and principal axes of a set of points.
template <typename S>
struct PrincipalAxes {
  Vector3<S> mean = Vector3<S>::Zero();
  Vector3<S> variance = Vector3<S>::Zero();     ///< along the axes (divided by n), ascending, never negative
  Matrix3<S> axes = Matrix3<S>::Identity();     ///< columns, unit, by ascending variance; signs are arbitrary
  /// Surface variation lambda0 / (lambda0 + lambda1 + lambda2) (Pauly et al., 2002); 0 where all points coincide.
  S curvature() const {
    const S sum = variance.sum();
    return sum > 0 ? variance[0] / sum : S(0);
  }
};

/// Eigenvalues (ascending, clamped at 0) and axes of a covariance matrix.
template <typename S>
PrincipalAxes<S> principal_axes(const Vector3<S>& mean, const Matrix3<S>& covariance) {
  PrincipalAxes<S> out;
  out.mean = mean;
  // Computed in double with the entries scaled to one: the closed form loses half of the digits.
  const Eigen::Matrix3d c = covariance.template cast<double>();
  const double scale = c.cwiseAbs().maxCoeff();
  if (!(scale > 0.0)) return out;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(c / scale);
  // Where two eigenvalues nearly coincide the closed form's axes are poor: iterate instead.
  const Eigen::Vector3d w = solver.eigenvalues();
  if (w[1] - w[0] < 1e-4 || w[2] - w[1] < 1e-4) solver.compute(c / scale);
  out.variance = (solver.eigenvalues() * scale).cwiseMax(0.0).template cast<S>();
  out.axes = solver.eigenvectors().template cast<S>();
  return out;
}

/// Principal axes of the points `indices` of a cloud (any range of integers). Sums are taken relative to the first point, so
/// that clouds far from the origin lose nothing. No points: zero mean and variance.
template <typename C, typename Range>
PrincipalAxes<scalar_t<C>> principal_axes(const C& cloud, const Range& indices) {
  using S = scalar_t<C>;
  double n = 0.0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const auto i : indices) {
    const Eigen::Vector3d p = point(cloud, static_cast<std::size_t>(i)).template cast<double>();
    if (n == 0.0) origin = p;
    const Eigen::Vector3d d = p - origin;
    sum += d;
    squares.noalias() += d * d.transpose();
    n += 1.0;
  }
  if (n == 0.0) return {};
  const Eigen::Vector3d mean = sum / n;
  const Eigen::Matrix3d covariance = squares / n - mean * mean.transpose();
  return principal_axes<S>(Vector3<S>((origin + mean).template cast<S>()), Matrix3<S>(covariance.template cast<S>()));
}

}  // namespace agrisee
