// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Answers a planner's view requests for an arm of the UR family: inverse kinematics, joint limits, keep-out spaces and
/// self-collision. Checks the answers of other arms.
#pragma once

#include <agrisee/arm/mount.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/workcell.hpp>

namespace agrisee::plan {

/// How the arm of a workcell is mounted, how it holds its sensor, and the spaces that neither may enter. Joint limits
/// are those of the arm's model, the housing is the sensor's.
arm::Mount mount_of(const Workcell& workcell);

/// A request without the distances that a camera does not measure; nothing if it measures none of them.
std::optional<ViewRequest> within_range(ViewRequest request, const sensor::DepthCamera& camera);

/// The reach of a workcell's arm. Distances outside the sensor's range are never offered. See arm::reach for which of
/// several solutions is chosen, and for the cost.
/// @throws ParameterError when the workcell's mount is not valid
Reach reach_of(const Workcell& workcell);

/// A reach that asks another only for distances in the camera's range, and checks its answers.
/// @param reach of an arm that is not the workcell's
/// @return throws InputError for an answer whose pose is not rigid, does not look at the requested target to within
///   0.1 m, is more than 0.02 m beyond the limits of the distance, or sees the target from more than 15 degrees beside
///   the requested direction; whose joints are not finite, or whose move time is negative or not finite
Reach checked(Reach reach, const sensor::DepthCamera& camera);

}  // namespace agrisee::plan
