// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Answers approach requests for an arm of the UR family. Of the joint angles that put the tool at the pre-grasp pose,
/// it chooses those which the arm reaches soonest and from which it can follow the straight approach: within its joint
/// limits, outside the spaces to keep out of, and clear of itself and of the other fruit. World frame, metres. Cost: 2
/// us when nothing is in reach, about 50 us for an approach.
#pragma once

#include <agrisee/arm/mount.hpp>
#include <agrisee/pick/approach.hpp>
#include <agrisee/workcell.hpp>

namespace agrisee::pick {

/// Whether the arm at joint angles `q` (rad) overlaps one of some ellipsoids (world); the arm's base is not tested.
bool meets_any(const Joints& q, const arm::Mount& mount, const std::vector<OrientedEllipsoid>& ellipsoids);

/// Approaches of a mounted arm. The keep-out spaces of `mount` are not used: each request brings its own.
/// @param mount how the arm stands in its cell and holds its sensor
/// @param tool0_T_tool pose of the gripper: origin at its gripping point, z axis pointing ahead
/// @param parameters see their struct
/// @throws ParameterError when the mount or the parameters are not valid, InputError when tool0_T_tool is not rigid
ReachApproach approach_of(arm::Mount mount, const Pose& tool0_T_tool, const PickingParameters& parameters = {});

/// Approaches of a workcell's arm with the gripper at `workcell.tool0_T_tool`, or, where that is empty,
/// `parameters.tool_length` ahead of the sensor, on the optical axis.
/// @throws ParameterError when the workcell's mount or the parameters are not valid
ReachApproach approach_of(const Workcell& workcell, const PickingParameters& parameters = {});

}  // namespace agrisee::pick
