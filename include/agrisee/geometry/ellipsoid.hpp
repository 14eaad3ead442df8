// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Solid ellipsoids of any orientation, and the distance of points and segments from them. With nearest_point and
/// support they can be tested for overlap by geometry/overlap.hpp. Metres; all solids in one frame.
/// Defined in `agrisee::agrisee`.
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
bool contains(const OrientedEllipsoid& e, const Eigen::Vector3d& p);

/// The point of an ellipsoid nearest to p; p itself if it lies inside. In the frame of the semi-axes r, the nearest
/// point of the surface to y is x_i = r_i^2 y_i / (t + r_i^2), where t is the root of a convex decreasing function, so
/// Newton's method from t = 0 cannot overshoot (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a
/// Hyperellipsoid", 2013). About 50 ns.
Eigen::Vector3d nearest_point(const OrientedEllipsoid& e, const Eigen::Vector3d& p);

/// Support function: the largest v . x over the points x of an ellipsoid.
double support(const OrientedEllipsoid& e, const Eigen::Vector3d& v);

/// Distance (m) from an ellipsoid to a point; 0 inside.
double distance(const OrientedEllipsoid& e, const Eigen::Vector3d& p);

/// Distance (m) from an ellipsoid to the segment from a to b; 0 if they intersect. Exact to about 1e-8 m. The distance
/// is convex along the segment. The sign of its derivative is that of the dot product of the segment's direction and
/// the vector from the nearest point, so bisection finds the minimum. About 1 us.
double distance(const OrientedEllipsoid& e, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace agrisee
