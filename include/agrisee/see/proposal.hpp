// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Views that are proposed to look at a frontier (paper, eq. 3). World frame, metres.
#pragma once

#include <agrisee/see/frontier.hpp>

namespace agrisee::see {

/// A place to look from. Roll is free, and so is the distance within the sensor's range.
struct ViewProposal {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< of the sensor
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit, along the optical axis
  Index frontier = -1;                                   ///< the point that it is for, by its index in the cloud
  int visible = 0;                                       ///< how many of the updated frontiers it sees (out-degree)
  double score = 0.0;                                    ///< `visible` per metre from the sensor
};

/// The view of the point `target` from the side `side` (unit) at a distance (m): v = p + d side, looking along -side.
inline ViewProposal view_of(const Eigen::Vector3d& target, Index index, const Eigen::Vector3d& side, double distance) {
  ViewProposal v;
  v.position = target + distance * side;
  v.direction = -side;
  v.frontier = index;
  return v;
}

/// The view along the frontier's normal: v = p_f + d n (paper, eq. 3).
inline ViewProposal propose(const Frontier& f, double view_distance) {
  return view_of(f.point, f.index, f.normal, view_distance);
}

/// The side of the point `target` on which a view stands, as a unit vector; the view's own direction where it stands on
/// it.
inline Eigen::Vector3d side_of(const ViewProposal& view, const Eigen::Vector3d& target) {
  const Eigen::Vector3d d = view.position - target;
  const double length = d.norm();
  return length > 0.0 ? Eigen::Vector3d(d / length) : Eigen::Vector3d(-view.direction);
}

/// The unit vector at the share `t` (0..1) of the great arc from the unit vector `a` to `b`; any arc where they are
/// opposite.
inline Eigen::Vector3d between(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double t) {
  Eigen::Vector3d across = b - a.dot(b) * a;
  const double sine = across.norm();
  if (sine < 1e-9 && a.dot(b) > 0.0) return a;
  across = sine < 1e-9 ? any_orthogonal<double>(a) : Eigen::Vector3d(across / sine);
  const double angle = t * std::atan2(sine, a.dot(b));
  return std::cos(angle) * a + std::sin(angle) * across;
}

/// The next view of a frontier that a view `last` left uncovered (SEE++): moved by `factor` times the offset from the
/// centroid (m) of what it added near the frontier to the frontier itself, at the same distance and looking at it
/// again.
inline ViewProposal shift_view(const ViewProposal& last, const Frontier& f, const Eigen::Vector3d& added_centroid,
                               double factor, double view_distance) {
  ViewProposal moved = last;
  moved.position += factor * (f.point - added_centroid);
  return view_of(f.point, f.index, side_of(moved, f.point), view_distance);
}

}  // namespace agrisee::see
