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
  Vector3<S> mean = Vector3<S>::Zero();         ///< m
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

/// Mean and covariance (divided by n) of points as they come, in double. Sums are taken relative to an origin that should
/// lie among the points, so that clouds far from zero lose nothing.
class Moments {
 public:
  Moments() { reset(Eigen::Vector3d::Zero()); }
  /// Begin anew; sums are taken about `origin` (m), which spares them rounding.
  void reset(const Eigen::Vector3d& origin) {
    origin_ = origin;
    n_ = x_ = y_ = z_ = xx_ = xy_ = xz_ = yy_ = yz_ = zz_ = 0.0;
  }
  /// Take in a point (m).
  void add(const Eigen::Vector3d& p) {
    const double x = p.x() - origin_.x(), y = p.y() - origin_.y(), z = p.z() - origin_.z();
    n_ += 1.0;
    x_ += x, y_ += y, z_ += z;
    xx_ += x * x, xy_ += x * y, xz_ += x * z, yy_ += y * y, yz_ += y * z, zz_ += z * z;
  }
  /// Number of points.
  double count() const { return n_; }
  /// The origin without points.
  Eigen::Vector3d mean() const { return n_ > 0.0 ? Eigen::Vector3d(origin_ + offset()) : origin_; }
  /// Zero without points.
  Eigen::Matrix3d covariance() const {
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    if (n_ == 0.0) return c;
    c << xx_, xy_, xz_, xy_, yy_, yz_, xz_, yz_, zz_;
    return c / n_ - offset() * offset().transpose();
  }

 private:
  Eigen::Vector3d offset() const { return Eigen::Vector3d(x_, y_, z_) / n_; }
  Eigen::Vector3d origin_;
  double n_, x_, y_, z_, xx_, xy_, xz_, yy_, yz_, zz_;
};

/// Principal axes of the points `indices` of a cloud (any range of integers). No points: zero mean and variance.
template <typename C, typename Range>
PrincipalAxes<scalar_t<C>> principal_axes(const C& cloud, const Range& indices) {
  using S = scalar_t<C>;
  Moments moments;
  for (const auto i : indices) {
    const Eigen::Vector3d p = point(cloud, static_cast<std::size_t>(i)).template cast<double>();
    if (moments.count() == 0.0) moments.reset(p);
    moments.add(p);
  }
  const PrincipalAxes<double> axes = principal_axes<double>(moments.mean(), moments.covariance());
  return {axes.mean.template cast<S>(), axes.variance.template cast<S>(), axes.axes.template cast<S>()};
}

}  // namespace agrisee
