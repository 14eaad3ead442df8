// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Spheres and ellipsoids as bodies that points are fitted to.
///
/// An ellipsoid is { p : |A (p - c)| = 1 } with A symmetric and positive definite. The distance of a point p from it is
/// taken to first order at the point's radial projection: (g - 1) g / |A A (p - c)| with g = |A (p - c)| (cf. Taubin,
/// PAMI 1991). Metres.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <utility>

namespace agrisee {

/// A sphere (m).
struct Sphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m
  double radius = 0.0;                               ///< m
};

/// An ellipsoid in the form that the fit works with.
struct Ellipsoid {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();   ///< symmetric; its eigenvalues are the inverse semi-axes (1/m)

  Ellipsoid() = default;
  /// A sphere as an ellipsoid.
  explicit Ellipsoid(const Sphere& s) : center(s.center), A(Eigen::Matrix3d::Identity() / s.radius) {}
  /// The product A v, written out because Eigen's general product is not inlined.
  Eigen::Vector3d times(const Eigen::Vector3d& v) const {
    return {A(0, 0) * v.x() + A(0, 1) * v.y() + A(0, 2) * v.z(), A(1, 0) * v.x() + A(1, 1) * v.y() + A(1, 2) * v.z(),
            A(2, 0) * v.x() + A(2, 1) * v.y() + A(2, 2) * v.z()};
  }
  /// Where a point is relative to the surface.
  struct Foot {
    double distance;         ///< signed distance of the point (m), to first order, negative inside
    Eigen::Vector3d normal;  ///< unit, outward, at the point's foot
  };
  /// The foot of p (m).
  Foot foot(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d a = times(p - center), n = times(a);
    const double g = a.norm(), slope = n.norm();
    if (!(slope > 0.0)) return {-mean_radius(), Eigen::Vector3d::UnitZ()};
    return {(g - 1.0) * g / slope, n / slope};
  }
  /// Signed distance of p from the surface (m); see foot().
  double distance(const Eigen::Vector3d& p) const { return foot(p).distance; }
  /// Unit normal at the foot of p, outward.
  Eigen::Vector3d normal(const Eigen::Vector3d& p) const { return foot(p).normal; }
  /// Harmonic mean of the semi-axes (m).
  double mean_radius() const { return 3.0 / A.trace(); }
  /// Mean of the semi-axes (m), at least mean_radius().
  double mean_semi_axis() const { return A.inverse().trace() / 3.0; }
  /// Point of the surface in direction `d` (unit) from the center.
  Eigen::Vector3d surface(const Eigen::Vector3d& d) const { return center + d / (A * d).norm(); }
};

/// Semi-axes (m, largest first) and their directions (columns, right-handed).
inline std::pair<Eigen::Vector3d, Eigen::Matrix3d> semi_axes(const Ellipsoid& e) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(e.A);  // ascending: smallest inverse first
  Eigen::Matrix3d axes = solver.eigenvectors();
  for (int i = 0; i < 2; ++i) {  // a rule for the signs, so that equal bodies print alike
    Eigen::Index largest;
    axes.col(i).cwiseAbs().maxCoeff(&largest);
    if (axes(largest, i) < 0.0) axes.col(i) *= -1.0;
  }
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return {solver.eigenvalues().cwiseInverse(), axes};
}

}  // namespace agrisee
