// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Solid ellipsoids of any direction: how far points and segments are from them, and whether they overlap the solids of
/// geometry/overlap.hpp, which asks for nearest_point and support. Metres, one frame for both.
#pragma once

#include <agrisee/geometry/overlap.hpp>

namespace agrisee {

/// A solid ellipsoid (m).
struct OrientedEllipsoid {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();    ///< m
  Eigen::Vector3d radii = Eigen::Vector3d::Zero();     ///< semi-axes, all positive
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: their directions
};

/// Whether a point lies inside or on an ellipsoid.
inline bool contains(const OrientedEllipsoid& e, const Eigen::Vector3d& p) {
  return (e.axes.transpose() * (p - e.center)).cwiseQuotient(e.radii).squaredNorm() <= 1.0;
}

/// The point of an ellipsoid that is nearest to p; p itself where it lies inside. On the surface x_i = r_i^2 y_i / (t +
/// r_i^2), and t is the root of a function that falls and is convex, so Newton's method from t = 0 cannot overshoot
/// (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid", 2013). About 50 ns.
inline Eigen::Vector3d nearest_point(const OrientedEllipsoid& e, const Eigen::Vector3d& p) {
  const Eigen::Vector3d y = e.axes.transpose() * (p - e.center), squares = e.radii.cwiseAbs2();
  if (y.cwiseQuotient(e.radii).squaredNorm() <= 1.0) return p;
  const Eigen::Vector3d moments = squares.cwiseProduct(y.cwiseAbs2());
  double t = 0.0;
  for (int i = 0; i < 60; ++i) {
    double value = -1.0, slope = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double s = t + squares[k], term = moments[k] / (s * s);
      value += term;
      slope -= 2.0 * term / s;
    }
    const double step = -value / slope;
    if (!(step > 1e-14 * squares[0])) break;
    t += step;
  }
  return e.center + e.axes * squares.cwiseProduct(y).cwiseQuotient((squares.array() + t).matrix());
}

/// The support function: the largest v . x over the points x of an ellipsoid.
inline double support(const OrientedEllipsoid& e, const Eigen::Vector3d& v) {
  return v.dot(e.center) + e.radii.cwiseProduct(e.axes.transpose() * v).norm();
}

/// Distance (m) from an ellipsoid to a point, 0 inside.
inline double distance(const OrientedEllipsoid& e, const Eigen::Vector3d& p) {
  return (p - nearest_point(e, p)).norm();
}

/// Distance (m) from an ellipsoid to the segment from a to b, 0 where they touch; exact to about 1e-8 m. The distance
/// is convex along the segment, and its derivative there is the segment's direction along the line from the nearest
/// point, so bisection finds the minimum. About 1 us.
inline double distance(const OrientedEllipsoid& e, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  double lo = 0.0, hi = 1.0, least = std::min(distance(e, a), distance(e, b));
  for (int i = 0; i < 30 && least > 0.0; ++i) {
    const double t = 0.5 * (lo + hi);
    const Eigen::Vector3d p = a + t * d, away = p - nearest_point(e, p);
    least = std::min(least, away.norm());
    const double slope = away.dot(d);
    if (slope == 0.0) break;
    (slope < 0.0 ? lo : hi) = t;
  }
  return least;
}

}  // namespace agrisee
