// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The straight approach of a gripper to a fruit: the space that the gripper sweeps, and the request by which an arm is
/// asked whether it can follow the approach. World frame, metres.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/ellipsoid.hpp>
#include <agrisee/pick/parameters.hpp>
#include <agrisee/result.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace agrisee::pick {

/// Distance (m) from the center of an ellipsoid to its surface along a unit vector.
double surface_distance(const OrientedEllipsoid& ellipsoid, const Eigen::Vector3d& direction);

/// The space that the gripper sweeps on its approach to a fruit along the unit vector `direction`: a capsule that
/// begins `stand_off` before the fruit's surface, extended backwards by the length of the tool, and ends at the fruit's
/// center.
Capsule swept_gripper(const OrientedEllipsoid& fruit, const Eigen::Vector3d& direction,
                      const PickingParameters& parameters);

/// The part of the swept gripper that has to stay out of keep-out spaces: its cap ends at the fruit's center instead of
/// a gripper's radius behind it. So fruit just before a wall can be picked from the front.
Capsule short_of_center(const Capsule& swept);

/// Whether a capsule and an ellipsoid overlap by more than kTouch. Spheres inside and around the ellipsoid decide most
/// cases quickly.
bool meets(const Capsule& capsule, const OrientedEllipsoid& ellipsoid);

/// A request to approach a fruit: the origin of the tool moves straight from `start` to `end`, with the tool's z axis
/// along `direction`. The roll about that axis is free, but does not change on the way. World frame, metres.
struct ApproachRequest {
  Eigen::Vector3d direction;                     ///< unit vector
  Eigen::Vector3d start;                         ///< origin of the tool at the pre-grasp pose (m)
  Eigen::Vector3d end;                           ///< origin of the tool at the end of the approach (m)
  const std::vector<KeepOut>& keep_out;          ///< the spaces to keep out of that apply to this fruit
  const std::vector<OrientedEllipsoid>& others;  ///< the other fruit that are still hanging
};

/// An approach that an arm can follow.
struct ReachableApproach {
  Pose world_T_pre_grasp = Pose::Identity();  ///< pose of the tool before the approach
  std::optional<Joints> joints;               ///< joint angles there (rad); empty when the arm does not report them
};

/// The answer to an approach request. When the arm cannot follow the approach, `arm_meets_fruit` is the only reason
/// that may no longer hold after other fruit have been picked.
struct ApproachAnswer {
  std::optional<ReachableApproach> reached;            ///< empty when the arm cannot follow the approach
  PickingReason reason = PickingReason::out_of_reach;  ///< `reachable` if it can, otherwise why it cannot
};

/// Answers an approach request for an arm whose joints are at `current` (rad). The same request has to get the same
/// answer each time.
using ReachApproach = std::function<ApproachAnswer(const ApproachRequest&, const Joints& current)>;

/// An approach function that checks the answers of another.
/// @param approach of an arm that is not the workcell's
/// @return throws InputError for an answer whose reason contradicts it, whose pre-grasp pose is not rigid, or has its
///   origin more than 2 mm from the start or its z axis more than 1 degree beside the direction of the request, or
///   whose joints are not finite
ReachApproach checked(ReachApproach approach);

}  // namespace agrisee::pick
