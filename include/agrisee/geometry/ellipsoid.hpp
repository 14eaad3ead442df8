// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Solid ellipsoids of any orientation, and the distance of points and segments from them. With nearest_point and
/// support they can be tested for overlap by geometry/overlap.hpp. Metres; all solids in one frame.
#pragma once

#include <agrisee/geometry/overlap.hpp>

namespace agrisee {

/// A solid ellipsoid (m).
struct OrientedEllipsoid {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();    ///< m
  Eigen::Vector3d radii = Eigen::Vector3d::Zero();     ///< semi-axes (m), all positive
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: unit directions of the semi-axes
};

/// True if a point lies inside an ellipsoid or on its surface.
inline bool contains(const OrientedEllipsoid& e, const Eigen::Vector3d& p) {
  return (e.axes.transpose() * (p - e.center)).cwiseQuotient(e.radii).squaredNorm() <= 1.0;
}

/// The point of an ellipsoid nearest to p; p itself if it lies inside. In the frame of the semi-axes r, the nearest
/// point of the surface to y is x_i = r_i^2 y_i / (t + r_i^2), where t is the root of a convex decreasing function, so
/// Newton's method from t = 0 cannot overshoot (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a
/// Hyperellipsoid", 2013). About 50 ns.
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

/// Support function: the largest v . x over the points x of an ellipsoid.
inline double support(const OrientedEllipsoid& e, const Eigen::Vector3d& v) {
  return v.dot(e.center) + e.radii.cwiseProduct(e.axes.transpose() * v).norm();
}

/// Distance (m) from an ellipsoid to a point; 0 inside.
inline double distance(const OrientedEllipsoid& e, const Eigen::Vector3d& p) {
  return (p - nearest_point(e, p)).norm();
}

/// Distance (m) from an ellipsoid to the segment from a to b; 0 if they intersect. Exact to about 1e-8 m. The distance
/// is convex along the segment. The sign of its derivative is that of the dot product of the segment's direction and
/// the vector from the nearest point, so bisection finds the minimum. About 1 us.
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
