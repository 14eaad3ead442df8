// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The solids of collision checks, and distances to them: boxes and upright cylinders for forbidden spaces, capsules
/// for the links of an arm. Metres. The distance to a solid is 0 inside it. Overlap of two solids is in
/// geometry/overlap.hpp. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

namespace agrisee {

/// An axis-aligned solid box (m).
struct Box {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< full edge lengths (m)
};

/// A solid cylinder (m) with its axis parallel to the z axis of world.
struct Cylinder {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m
  double radius = 0.0;                               ///< m
  double height = 0.0;                               ///< full height (m), half of it on either side of the center
};

/// A space that neither the arm nor the sensor may enter. It does not block the sensor's view.
struct KeepOut {
  std::string name;                   ///< used in messages
  std::variant<Box, Cylinder> shape;  ///< in world

  /// @throws ParameterError with the name of the space if a size is not positive or a number not finite
  void check() const;
};

/// All points within `radius` (m) of the segment from a to b.
struct Capsule {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();  ///< one end of its axis (m)
  Eigen::Vector3d b = Eigen::Vector3d::Zero();  ///< the other end (m)
  double radius = 0.0;                          ///< m
};

/// Distance (m) from a point to a box; 0 inside.
double distance(const Box& box, const Eigen::Vector3d& p);
/// Distance (m) from a point to a cylinder; 0 inside.
double distance(const Cylinder& c, const Eigen::Vector3d& p);
/// Distance (m) from a point to a forbidden space; 0 inside.
double distance(const KeepOut& k, const Eigen::Vector3d& p);

/// Distance (m) from a box to the segment from a to b; 0 if they intersect. Exact: the derivative of the squared
/// distance along the segment increases, and it is linear between the at most six points where the segment crosses the
/// planes of the box's faces. The minimum is interpolated between the two of these points on either side of the zero.
double distance(const Box& box, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Distance (m) from an upright cylinder to the segment from a to b; 0 if they intersect. Exact to about 1e-12 m. The
/// squared distance is convex along the segment; Newton's method finds the zero of its derivative, kept inside a
/// shrinking bracket.
double distance(const Cylinder& c, const Eigen::Vector3d& a, const Eigen::Vector3d& b);
/// Distance (m) from a forbidden space to the segment from a to b; 0 if they intersect.
double distance(const KeepOut& k, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Distance (m) between the segments from p1 to q1 and from p2 to q2 (Ericson, Real-Time Collision Detection, 5.1.9).
double segment_distance(const Eigen::Vector3d& p1, const Eigen::Vector3d& q1, const Eigen::Vector3d& p2,
                        const Eigen::Vector3d& q2);

}  // namespace agrisee
