// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How to pick the fruit that were found: a direction of approach and a pre-grasp pose for each, clear of the other
/// fruit and of the keep-out spaces; whether an arm can follow the approach; and the order in which to pick.
///
/// On its approach the gripper sweeps a capsule about the line from the pre-grasp position to the fruit's center; no
/// part of it beyond the center counts for keep-out spaces. A keep-out space that contains the fruit's center does not
/// apply to that fruit (a cylinder about the truss keeps the arm away while it looks, not while it picks). Whether the
/// arm can follow an approach is answered by a callable, so that any robot's own motion planner can be used;
/// pick/arm_approach.hpp answers for the arms of the UR family.
///
/// What was measured beside the fruit is no obstacle by itself, as leaves give way: approaches that cross less of it
/// are preferred, and those that cross more than `max_crossed` are not taken. What is crossed is part of the plan.
///
/// Fruit are planned in rounds: first those whose approach is free while all the others are hanging, then those that
/// are free once these have been picked, and so on. A round admits approaches through more of the surroundings only if
/// no fruit is free through less. Within a round the fruit nearest to the robot come first; among
/// fruit whose depths differ by less than `depth_tie` the arm's shortest move decides. The plan does not depend on the
/// order in which the fruit and the points of the surroundings are given. World frame, metres. Cost: a few ms for nine
/// fruit with the UR3, and up to 1 ms more per fruit among 20,000 points of leaves; a fruit that no direction reaches
/// costs most.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/pick/approach.hpp>
#include <agrisee/pick/surroundings.hpp>

#include <bitset>

namespace agrisee::pick {

/// The directions from a fruit's center in which its surface was observed, one bit per bin of DirectionBins.
using SeenDirections = std::bitset<DirectionBins::kCount>;

/// What surrounds the fruit.
struct PickingScene {
  std::vector<KeepOut> keep_out;                    ///< spaces to keep out of (world)
  Eigen::Vector3d robot = Eigen::Vector3d::Zero();  ///< where the robot's base stands (m, world); defines the front
  Joints joints = Joints::Zero();                   ///< of the arm before the first pick (rad)
  std::vector<SeenDirections> seen = {};            ///< one per fruit, or empty when it is not known
  Cloud surroundings = {};                          ///< points of no fruit (m, world): see surroundings_of
};

/// The directions in which each fruit's surface was observed: those from the center of its body to its points.
/// @param cloud points (m, world)
/// @param labels one per point: the id of its fruit, 0 = none
/// @param fruits as located
/// @return one per fruit; no bit is set for a fruit without a body
std::vector<SeenDirections> seen_directions(const Cloud& cloud, const Labels& labels, const std::vector<Fruit>& fruits);

/// The space that a fruit takes up: its body, or, when none was fitted, a sphere about the mean of its points whose
/// radius is their standard deviation.
OrientedEllipsoid occupied(const Fruit& fruit);

/// Plan the picking of all fruit.
/// @param fruits as located
/// @param scene what surrounds them
/// @param reach answers whether the arm can follow an approach; when empty, directions and order are planned without
///   an arm and the reason is `not_tested`
/// @param parameters see their struct
/// @return one entry per fruit, in the order of `fruits`
/// @throws InputError when a fruit, the robot's position or a joint is not finite, when two fruits have the same id,
///   when `scene.seen` is neither empty nor has one entry per fruit, or as check_lengths of `scene.surroundings`;
///   ParameterError
std::vector<Picking> plan_picking(const std::vector<Fruit>& fruits, const PickingScene& scene,
                                  const ReachApproach& reach = {}, const PickingParameters& parameters = {});

}  // namespace agrisee::pick
