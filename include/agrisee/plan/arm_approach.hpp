// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether and how our UR3 model can approach a fruit: joint angles at the pre-grasp pose that it reaches soonest, from
/// which it can follow the straight line, within its limits, out of the spaces to keep out of, free of itself and of
/// the other fruit. Cost: 2 us where nothing is in reach, about 50 us for an approach.
#pragma once

#include <agrisee/arm/reachability.hpp>
#include <agrisee/plan/approach.hpp>

#include <algorithm>

namespace agrisee::plan {

/// Whether the arm at joint angles `q`, but its base, overlaps one of some ellipsoids.
inline bool meets_any(const Joints& q, const arm::Mount& mount, const std::vector<OrientedEllipsoid>& bodies) {
  const auto pieces = arm::pieces_in_world(q, mount);
  for (const OrientedEllipsoid& body : bodies) {
    const double size = body.radii.maxCoeff();
    for (const arm::Piece& piece : pieces) {
      const double reach = 0.5 * (piece.capsule.b - piece.capsule.a).norm() + piece.capsule.radius + size;
      if (piece.part == arm::Part::base || (piece.cylinder.center - body.center).squaredNorm() > reach * reach)
        continue;
      if (meets(piece.capsule, body) && overlap(piece.cylinder, body)) return true;
    }
  }
  return false;
}

namespace detail {

/// The UR3 on its way to one fruit.
struct ArmOnItsWay {
  const arm::Mount& mount;  // its spaces are those that count for the fruit
  const Pose& base_T_world;
  const Pose& tool_T_tool0;
  const ApproachRequest& request;
  const PickingParameters& parameters;

  /// base_link_T_tool0 with the tool's origin at `position`, turned by the roll's number.
  Pose tool0_at(const Eigen::Vector3d& position, int roll) const {
    return base_T_world * look_along(position, request.direction, kTwoPi * roll / parameters.rolls) * tool_T_tool0;
  }
  /// What a posture runs into.
  PickingReason verdict(const Joints& q) const {
    if (arm::collides(q, mount)) return PickingReason::arm_collision;
    return meets_any(q, mount, request.others) ? PickingReason::arm_meets_fruit : PickingReason::reachable;
  }
  /// Whether the arm can follow the line from joints `q` at its start.
  PickingReason follow(Joints q, int roll) const {
    const PickingReason start = verdict(q);
    if (start != PickingReason::reachable) return start;
    for (int step = 1; step <= parameters.steps; ++step) {
      const double t = static_cast<double>(step) / parameters.steps;
      const Eigen::Vector3d position = request.start + t * (request.end - request.start);
      std::optional<Joints> next;
      double least = parameters.max_joint_step;
      arm::detail::for_each_solution(tool0_at(position, roll), q[5], [&](const Joints& solution) {
        const auto near = arm::nearest(solution, q, mount.limits);
        if (!near) return;
        const double turn = (*near - q).cwiseAbs().maxCoeff();
        if (turn < least) least = turn, next = near;
      });
      if (!next) return PickingReason::approach_interrupted;
      const PickingReason here = verdict(*next);
      if (here == PickingReason::arm_meets_fruit) return here;
      if (here != PickingReason::reachable) return PickingReason::approach_interrupted;
      q = *next;
    }
    return PickingReason::reachable;
  }
};

}  // namespace detail

/// Approaches of the UR3 of a mounting; its own spaces to keep out of are replaced by those of each wish.
/// @param mount the arm and its cell
/// @param tool0_T_tool the gripper: origin at its gripping point, z ahead
/// @param parameters see their struct
/// @throws ParameterError when mounting or parameters are not sound, InputError when tool0_T_tool is not rigid
inline ReachApproach approach_of(arm::Mount mount, const Pose& tool0_T_tool, const PickingParameters& parameters = {}) {
  mount.check();
  parameters.check();
  check_input(is_rigid(tool0_T_tool), "approach_of: tool0_T_tool is not finite or not a rigid pose");
  mount.keep_out.clear();
  const Pose base_T_world = mount.world_T_base.inverse(), tool_T_tool0 = tool0_T_tool.inverse();
  const auto on_axis = [](const Pose& tool0_T_frame) {
    const Eigen::Vector3d offset = tool0_T_frame.translation(), ahead = tool0_T_frame.linear().col(2);
    return std::max({std::abs(offset.x()), std::abs(offset.y()), std::abs(ahead.x()), std::abs(ahead.y())}) < 1e-9;
  };
  // A tool and a sensor on the last joint's axis: rolling turns that joint alone, so one roll's solutions are all
  // rolls', and what one of them meets all of them meet.
  const bool round = on_axis(tool0_T_tool) && on_axis(mount.tool0_T_optical) && tool0_T_tool.linear()(2, 2) > 0.0;
  return [=](const ApproachRequest& request, const Joints& current) -> ApproachAnswer {
    arm::Mount here = mount;
    here.keep_out = request.keep_out;
    const detail::ArmOnItsWay way{here, base_T_world, tool_T_tool0, request, parameters};
    struct Candidate {
      Joints joints;
      double time, turn;
      int roll, group;  // of a group, all or none can follow the line
    };
    std::vector<Candidate> candidates;
    int groups = 0;
    const auto offer = [&](const Joints& q, int roll, int group) {
      if (const auto near = arm::nearest(q, current, here.limits))
        candidates.push_back(
            {*near, arm::move_time(current, *near, here.limits), arm::joint_distance(current, *near), roll, group});
    };
    if (round) {
      if (!arm::maybe_reachable(way.tool0_at(request.start, 0))) return {std::nullopt, PickingReason::out_of_reach};
      arm::detail::for_each_solution(way.tool0_at(request.start, 0), current[5], [&](const Joints& q) {
        for (int roll = 0; roll < parameters.rolls; ++roll) {
          Joints rolled = q;
          rolled[5] += kTwoPi * roll / parameters.rolls;
          offer(rolled, roll, groups);
        }
        ++groups;
      });
    } else {
      for (int roll = 0; roll < parameters.rolls; ++roll)
        arm::detail::for_each_solution(way.tool0_at(request.start, roll), current[5],
                                       [&](const Joints& q) { offer(q, roll, groups++); });
    }
    if (candidates.empty()) return {std::nullopt, PickingReason::out_of_reach};
    std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
      return a.time != b.time ? a.time < b.time : a.turn < b.turn;
    });
    std::vector<char> rejected(static_cast<std::size_t>(groups), 0);
    PickingReason farthest = PickingReason::arm_collision;
    for (const Candidate& c : candidates) {
      if (rejected[static_cast<std::size_t>(c.group)]) continue;
      const PickingReason reason = way.follow(c.joints, c.roll);
      if (reason == PickingReason::reachable)
        return {ReachableApproach{look_along(request.start, request.direction, kTwoPi * c.roll / parameters.rolls),
                                  c.joints},
                PickingReason::reachable};
      rejected[static_cast<std::size_t>(c.group)] = 1;
      farthest = std::max(farthest, reason);
    }
    return {std::nullopt, farthest};
  };
}

}  // namespace agrisee::plan
