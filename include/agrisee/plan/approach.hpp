// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The straight approach of a gripper to a fruit: its parameters, the space that it sweeps, and the question whether an
/// arm can follow it. World frame, metres.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/ellipsoid.hpp>
#include <agrisee/plan/parameters.hpp>
#include <agrisee/result.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace agrisee::plan {

/// The gripper's way towards a fruit along `direction` (unit): from the pre-grasp position, and as far behind it as the
/// gripper is long, to the centre.
inline Capsule swept_gripper(const OrientedEllipsoid& fruit, const Eigen::Vector3d& direction,
                             const PickingParameters& p) {
  const double surface = 1.0 / (fruit.axes.transpose() * direction).cwiseQuotient(fruit.radii).norm();
  return {fruit.center - (surface + p.stand_off + p.tool_length) * direction, fruit.center, p.gripper_radius};
}

/// Whether a capsule overlaps an ellipsoid; spheres within and about it give the first answer.
inline bool meets(const Capsule& capsule, const OrientedEllipsoid& e) {
  const double apart = segment_distance(capsule.a, capsule.b, e.center, e.center);
  if (apart >= capsule.radius + e.radii.maxCoeff()) return false;
  if (apart < capsule.radius + e.radii.minCoeff() - kTouch) return true;
  return distance(e, capsule.a, capsule.b) < capsule.radius - kTouch;
}

/// A wish to approach a fruit: the tool's origin moves straight from `start` to `end` along `direction`, its z axis
/// along it, its roll free but the same all the way. World, metres.
struct ApproachRequest {
  Eigen::Vector3d direction;                     ///< unit
  Eigen::Vector3d start;                         ///< of the tool at the pre-grasp pose
  Eigen::Vector3d end;                           ///< of the tool at the end of the approach
  const std::vector<KeepOut>& keep_out;          ///< that count for this fruit
  const std::vector<OrientedEllipsoid>& others;  ///< the other fruit that hang there
};

/// An approach that an arm can follow.
struct ReachableApproach {
  Pose world_T_pre_grasp = Pose::Identity();  ///< of the tool
  std::optional<Joints> joints;               ///< absent where the caller moves without telling
};

/// The answer to a wish: how, or why not. Of the reasons only `arm_meets_fruit` may go away when other fruit are
/// picked.
struct ApproachAnswer {
  std::optional<ReachableApproach> reached;            ///< how; empty when it cannot be followed
  PickingReason reason = PickingReason::out_of_reach;  ///< why not
};

/// Answers a wish for an arm that comes from `current`. It has to give the same answer to the same question.
using ReachApproach = std::function<ApproachAnswer(const ApproachRequest&, const Joints& current)>;

}  // namespace agrisee::plan
