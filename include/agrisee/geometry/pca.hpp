// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Principal axes of small sets of points. Normals, curvatures and the local frames of frontiers are computed from
/// them.
#pragma once

#include <agrisee/core/traits.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace agrisee {

/// Surface variation l0 / (l0 + l1 + l2) of Pauly, Gross & Kobbelt, "Efficient Simplification of Point-Sampled
/// Surfaces", 2002, for the variances l0 <= l1 <= l2 along the principal axes; 0 if all are 0.
template <typename S>
S surface_variation(const Vector3<S>& variance) {
  const S sum = variance.sum();
  return sum > 0 ? variance[0] / sum : S(0);
}

/// Mean and principal axes of a set of points.
template <typename S>
struct PrincipalAxes {
  Vector3<S> mean = Vector3<S>::Zero();      ///< m
  Vector3<S> variance = Vector3<S>::Zero();  ///< along the axes (m2, divided by n), ascending, never negative
  Matrix3<S> axes = Matrix3<S>::Identity();  ///< unit columns in the order of `variance`; their signs are arbitrary
  /// Surface variation; 0 if all points coincide.
  S curvature() const { return surface_variation<S>(variance); }
};

/// Principal axes from a mean (m) and a covariance matrix (m2).
template <typename S>
PrincipalAxes<S> principal_axes(const Vector3<S>& mean, const Matrix3<S>& covariance) {
  PrincipalAxes<S> out;
  out.mean = mean;
  // In double and scaled to entries of about 1, since the closed form loses half of the digits.
  const Eigen::Matrix3d c = covariance.template cast<double>();
  const double scale = c.cwiseAbs().maxCoeff();
  if (!(scale > 0.0)) return out;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(c / scale);
  // If two eigenvalues nearly coincide, the axes of the closed form are inaccurate: iterate instead.
  const Eigen::Vector3d w = solver.eigenvalues();
  if (w[1] - w[0] < 1e-4 || w[2] - w[1] < 1e-4) solver.compute(c / scale);
  out.variance = (solver.eigenvalues() * scale).cwiseMax(0.0).template cast<S>();
  out.axes = solver.eigenvectors().template cast<S>();
  return out;
}

/// The axis of least variance of a covariance matrix, in a quarter of the time that all axes take. Newton's method from
/// below finds the least eigenvalue l; the axis is the longest column of the adjugate of (covariance - l I). If another
/// eigenvalue is nearly equal to l, an iterative solver is used instead.
/// @param covariance symmetric, without negative eigenvalues
/// @param variance receives the eigenvalues, ascending, never negative; if the larger two coincide, these are accurate
///   to half of their digits only
/// @return the axis, of unit length and arbitrary sign; both the axis and `variance` are zero if the matrix is zero,
///   not finite, or so small that its inverse overflows
inline Eigen::Vector3d least_axis(const Eigen::Matrix3d& covariance, Eigen::Vector3d& variance) {
  variance.setZero();
  const double scale = covariance.diagonal().maxCoeff();
  if (!(scale > 0.0)) return Eigen::Vector3d::Zero();
  const double up = 1.0 / scale;
  double xx = up * covariance(0, 0), yy = up * covariance(1, 1), zz = up * covariance(2, 2);
  const double xy = up * covariance(1, 0), xz = up * covariance(2, 0), yz = up * covariance(2, 1);
  // The characteristic polynomial x^3 - trace x^2 + minors x - determinant increases up to its least root.
  const double trace = xx + yy + zz;
  const double minors = (xx * yy - xy * xy) + (xx * zz - xz * xz) + (yy * zz - yz * yz);
  const double determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  if (!std::isfinite(trace) || !std::isfinite(minors) || !std::isfinite(determinant)) return Eigen::Vector3d::Zero();
  double least = 0.0;
  bool found = false;
  for (int i = 0; i < 16 && !found; ++i) {
    const double value = ((least - trace) * least + minors) * least - determinant;
    const double slope = (3.0 * least - 2.0 * trace) * least + minors;
    const double step = value < 0.0 && slope > 0.0 ? -value / slope : 0.0;
    least += step;
    found = step < 1e-13;
  }
  const double half = 0.5 * (trace - least),
               product = minors - 2.0 * half * least;  // mean and product of the other two
  const double most = half + std::sqrt(std::max(half * half - product, 0.0));
  const double middle = most > 0.0 ? std::min(product / most, most) : 0.0;
  // Rounding turns the axis by about epsilon / ((middle - least)^2 (most - least)).
  constexpr double kNear = 1e-7;
  if (!found || !(middle > least) || !((middle - least) * (middle - least) * (most - least) > kNear)) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(up * covariance);
    variance = scale * solver.eigenvalues().cwiseMax(0.0);
    return solver.eigenvectors().col(0);
  }
  variance = scale * Eigen::Vector3d(least, middle, most);
  xx -= least, yy -= least, zz -= least;
  const double a = yy * zz - yz * yz, b = xx * zz - xz * xz, c = xx * yy - xy * xy;  // entries of the adjugate
  const double ab = xz * yz - xy * zz, ac = xy * yz - xz * yy, bc = xy * xz - xx * yz;
  if (a >= b && a >= c) return Eigen::Vector3d(a, ab, ac).normalized();
  return b >= c ? Eigen::Vector3d(ab, b, bc).normalized() : Eigen::Vector3d(ac, bc, c).normalized();
}

/// Running mean and covariance (divided by n) of points that are added one by one, in double. Sums are taken relative
/// to an origin that should lie among the points, so that no digits are lost for points far from zero.
class Moments {
 public:
  Moments() { reset(Eigen::Vector3d::Zero()); }
  /// Removes all points and sets the origin (m) of the sums.
  void reset(const Eigen::Vector3d& origin) {
    origin_ = origin;
    n_ = x_ = y_ = z_ = xx_ = xy_ = xz_ = yy_ = yz_ = zz_ = 0.0;
  }
  /// Adds a point (m).
  void add(const Eigen::Vector3d& p) {
    const double x = p.x() - origin_.x(), y = p.y() - origin_.y(), z = p.z() - origin_.z();
    n_ += 1.0;
    x_ += x, y_ += y, z_ += z;
    xx_ += x * x, xy_ += x * y, xz_ += x * z, yy_ += y * y, yz_ += y * z, zz_ += z * z;
  }
  /// Number of points.
  double count() const { return n_; }
  /// Mean (m); the origin if there are no points.
  Eigen::Vector3d mean() const { return n_ > 0.0 ? Eigen::Vector3d(origin_ + offset()) : origin_; }
  /// Covariance (m2); zero if there are no points.
  Eigen::Matrix3d covariance() const {
    if (n_ == 0.0) return Eigen::Matrix3d::Zero();
    const double x = x_ / n_, y = y_ / n_, z = z_ / n_;
    const double xx = xx_ / n_ - x * x, xy = xy_ / n_ - x * y, xz = xz_ / n_ - x * z;
    const double yy = yy_ / n_ - y * y, yz = yz_ / n_ - y * z, zz = zz_ / n_ - z * z;
    Eigen::Matrix3d c;
    c.col(0) = Eigen::Vector3d(xx, xy, xz);
    c.col(1) = Eigen::Vector3d(xy, yy, yz);
    c.col(2) = Eigen::Vector3d(xz, yz, zz);
    return c;
  }

 private:
  Eigen::Vector3d offset() const { return Eigen::Vector3d(x_, y_, z_) / n_; }
  Eigen::Vector3d origin_;
  double n_, x_, y_, z_, xx_, xy_, xz_, yy_, yz_, zz_;
};

/// Principal axes of the points `indices` (any range of integers) of a cloud. Mean and variance are zero if there are
/// no points.
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
