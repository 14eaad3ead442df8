// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What to do with a frontier that remains a frontier after a view was taken for it (SEE++, view controller). World
/// frame, metres.
#pragma once

#include <agrisee/see/proposal.hpp>

#include <cmath>
#include <limits>

namespace agrisee::see {

/// What has been tried for a frontier point. It stays with the point when it is given up and becomes a frontier again.
struct ControllerState {
  double scale = 1.0;                                       ///< s: how far the next adjustment moves
  double offset = std::numeric_limits<double>::infinity();  ///< |o| at the last adjustment (m)
  bool switched = false;  ///< whether the view from where the point was first seen was tried
};

/// What the controller did.
enum class ControllerAction : std::uint8_t {
  adjusted,       ///< the view was moved towards what is unseen
  switched,       ///< the view is now from where the point was first seen
  nothing_helps,  ///< neither: the frontier is to be given up
};

/// The view's position after one adjustment (SEE++).
///
/// With the frontier's direction q and boundary b, the offset o from the centroid of the observation to the frontier,
/// and the view's position v relative to the frontier: v moves by (s + 1) o_q along q and is turned about q by
/// atan(s o_q d / (d^2 + (s + 1) o_q^2)); then the same along and about b with o_b. The turns take nothing from the
/// moves, which grow with s. As in the authors' program, which turns about the world's origin, where its objects are.
/// @param f the frontier
/// @param position of the view (m, world)
/// @param offset from the centroid of the whole observation to the frontier (m, world)
/// @param scale s
/// @param view_distance d (m)
/// @return position (m, world), at any distance from the frontier
inline Eigen::Vector3d adjusted_position(const Frontier& f, const Eigen::Vector3d& position,
                                         const Eigen::Vector3d& offset, double scale, double view_distance) {
  const double s = scale, d = view_distance;
  const auto step = [&](const Eigen::Vector3d& v, const Eigen::Vector3d& axis) {
    const double o = offset.dot(axis);
    const double angle = std::atan(s * o * d / (d * d + (s + 1.0) * o * o));
    return Eigen::Vector3d(Eigen::AngleAxisd(angle, axis) * (v + (s + 1.0) * o * axis));
  };
  return f.point + step(step(position - f.point, f.direction), f.boundary);
}

/// Decide what becomes of a frontier that its view did not cover. While |o| shrinks, the view is adjusted, and s
/// doubles each time. Otherwise it is replaced, once, by the view from where the point was first seen.
/// @param f the frontier
/// @param centroid of the whole observation (m, world)
/// @param seen_from position of the sensor that first saw the point (m, world)
/// @param view_distance distance of the new view (m)
/// @param state of the point; updated
/// @param view of the frontier; replaced by the new one
inline ControllerAction control_view(const Frontier& f, const Eigen::Vector3d& centroid,
                                     const Eigen::Vector3d& seen_from, double view_distance, ControllerState& state,
                                     ViewProposal& view) {
  const Eigen::Vector3d offset = f.point - centroid;
  const auto look_from = [&](const Eigen::Vector3d& position) {
    ViewProposal moved = view;
    moved.position = position;
    view = view_of(f.point, f.index, side_of(moved, f.point), view_distance);
  };
  if (offset.norm() < state.offset) {
    look_from(adjusted_position(f, view.position, offset, state.scale, view_distance));
    state.scale *= 2.0;
    state.offset = offset.norm();
    return ControllerAction::adjusted;
  }
  if (state.switched) return ControllerAction::nothing_helps;
  state = ControllerState();
  state.switched = true;
  look_from(seen_from);
  return ControllerAction::switched;
}

}  // namespace agrisee::see
