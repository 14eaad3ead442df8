// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Views that are proposed for a frontier ([1], eq. 3). World frame, metres.
#pragma once

#include <agrisee/see/frontier.hpp>

namespace agrisee::see {

/// A proposed view. Its roll is free, and so is its distance within the sensor's range.
struct ViewProposal {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< of the sensor (m, world)
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, along the optical axis
  Index frontier = -1;                                   ///< index in the cloud of the frontier point that it is for
  int visible = 0;                                       ///< number of frontiers that it is known to see
};

/// The view of the point `target` (m, world) from a side (unit vector) at a distance (m): v = p + d side, looking along
/// -side. `index` is that of the frontier.
inline ViewProposal view_of(const Eigen::Vector3d& target, Index index, const Eigen::Vector3d& side, double distance) {
  ViewProposal v;
  v.position = target + distance * side;
  v.direction = -side;
  v.frontier = index;
  return v;
}

/// The view along the frontier's normal, at the distance d (m): v = p_f + d n ([1], eq. 3).
inline ViewProposal propose(const Frontier& f, double view_distance) {
  return view_of(f.point, f.index, f.normal, view_distance);
}

/// Unit vector from the point `target` (m, world) to a view's position. If the two are equal: against the view's
/// direction.
inline Eigen::Vector3d side_of(const ViewProposal& view, const Eigen::Vector3d& target) {
  const Eigen::Vector3d d = view.position - target;
  const double length = d.norm();
  return length > 0.0 ? Eigen::Vector3d(d / length) : Eigen::Vector3d(-view.direction);
}

}  // namespace agrisee::see
