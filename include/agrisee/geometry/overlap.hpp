// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tests whether solids of an arm overlap forbidden spaces or each other: capsules for a quick conservative test,
/// flat-ended cylinders of any orientation for the exact one. Metres; all solids in one frame.
///
/// Solids that only touch do not overlap. All tests allow a penetration of kTouch, so a sensor may stand exactly at the
/// border of a forbidden space. A body that is no thicker than that, such as a line, overlaps what it enters or lies
/// on. If a coordinate is not finite, the tests report an overlap. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/geometry/primitives.hpp>

namespace agrisee {

/// Largest penetration (m) that still counts as touching.
constexpr double kTouch = 1e-6;

/// How far (m) a segment is from a solid if a capsule of this radius (m) about it only touches that; or from another
/// segment, if `radius` is the sum for both. Positive even for a line, so that none passes through a solid.
inline double touching_distance(double radius) { return std::max(radius - kTouch, 1e-9); }

/// A flat-ended solid cylinder (m) of any orientation.
struct OrientedCylinder {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< direction of the axis, unit
  double radius = 0.0;                               ///< m
  double height = 0.0;                               ///< full height (m), half of it on either side of the center
};

/// A capsule that encloses a cylinder. It has the same axis; its segment ends half a radius before the cylinder's ends,
/// so that it is 12 % wider than the cylinder and 0.62 radii longer at each end.
Capsule enclosing_capsule(const OrientedCylinder& c);

/// The point of a box nearest to p (m); p itself if it lies inside.
Eigen::Vector3d nearest_point(const Box& box, const Eigen::Vector3d& p);
/// The point of a cylinder nearest to p (m); p itself if it lies inside.
Eigen::Vector3d nearest_point(const OrientedCylinder& c, const Eigen::Vector3d& p);
/// The point of a cylinder nearest to p (m); p itself if it lies inside.
Eigen::Vector3d nearest_point(const Cylinder& c, const Eigen::Vector3d& p);

/// Support function: the largest v . x over the points x of a box.
double support(const Box& box, const Eigen::Vector3d& v);
/// Support function of a cylinder: the largest v . x over its points x.
double support(const Cylinder& c, const Eigen::Vector3d& v);

/// Support function of a cylinder: the largest v . x over its points x.
double support(const OrientedCylinder& c, const Eigen::Vector3d& v);

/// True if a capsule overlaps a Box, Cylinder or KeepOut. Takes about 5 ns if its middle is far away, otherwise 30 to
/// 200 ns.
template <typename Solid>
bool overlap(const Capsule& capsule, const Solid& solid) {
  const double reach = touching_distance(capsule.radius);
  const double half = 0.5 * (capsule.b - capsule.a).norm();
  const double middle = distance(solid, Eigen::Vector3d(0.5 * (capsule.a + capsule.b)));
  if (middle >= reach + half) return false;
  if (middle < reach) return true;
  return !(distance(solid, capsule.a, capsule.b) >= reach);
}

/// True if two capsules overlap.
bool overlap(const Capsule& a, const Capsule& b);

/// True if a cylinder of any orientation overlaps a Box, an upright Cylinder or another cylinder of any orientation.
///
/// The algorithm projects a point alternately onto the two convex solids (Bregman, 1965), with over-relaxation so that
/// it moves into their intersection rather than slowly along its border. It stops with a proof: either a point that
/// lies in both, or a plane that separates them, perpendicular to the line between two nearest points. Usually one or
/// two rounds of 20 ns suffice. About one case in a thousand, in which the solids graze each other, is still undecided
/// after 60 rounds and counts as an overlap.
template <typename Solid>
bool overlap(OrientedCylinder body, const Solid& solid) {
  constexpr int kRounds = 60;
  constexpr double kRelax = 1.8;
  body.radius = std::max(body.radius - kTouch, 0.0);
  body.height = std::max(body.height - 2.0 * kTouch, 0.0);
  Eigen::Vector3d p = body.center;
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Vector3d in_solid = nearest_point(solid, p), in_body = nearest_point(body, in_solid);
    const Eigen::Vector3d v = in_body - in_solid;  // v . x >= v . in_body for every point x of the body
    if (!(v.squaredNorm() > 1e-18)) return true;
    if (v.dot(in_body) > support(solid, v)) return false;
    p += kRelax * (in_solid - p);
    p += kRelax * (nearest_point(body, p) - p);
  }
  return true;
}
/// True if a cylinder overlaps a forbidden space.
bool overlap(const OrientedCylinder& body, const KeepOut& space);

}  // namespace agrisee
