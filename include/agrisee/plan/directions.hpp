// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Directions to look along, points to look at, and the first view of a scan. World frame.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/plan/planner.hpp>

namespace agrisee::plan {

/// `n` unit vectors spread evenly over the sphere (spherical Fibonacci lattice).
std::vector<Eigen::Vector3d> spread_directions(int n);

/// Set target and distance of the i-th of many requests that are spread evenly over the points to look at and the
/// distances: Roberts' R4 sequence, the fractional parts of i times powers of 1 / 1.1673, the inverse of the
/// generalised golden ratio in four dimensions.
/// @param request its target is the middle of the points; its limits are those of the distances
/// @param size of the box about that middle (m), of which the share `spread` is looked at
void spread_aim(ViewRequest& request, double i, const Eigen::Vector3d& size, double spread);

/// The horizontal unit vector that points from `from` to `to` (m, world); +y when one is straight above the other.
Eigen::Vector3d level_direction(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// The frontal direction of a scan: the horizontal unit vector from the robot's base to the center of the volume.
/// @param volume to be scanned (world)
/// @param robot where the robot's base stands (m, world)
Eigen::Vector3d frontal_direction(const Aabb& volume, const Eigen::Vector3d& robot);

/// The parts in which to look at a volume: all of it first and, if it is wider than `width`, boxes of at most this
/// width that fill it, at most 27, those nearest to its center first.
/// @param volume to be scanned (world)
/// @param width how wide a part may be (m, positive); more if there were too many
std::vector<Aabb> parts_to_look_at(const Aabb& volume, double width);

/// The reachable view of the volume's center whose direction is nearest to frontal; nothing when there is none.
/// @param volume to be scanned (world)
/// @param robot where the robot's base stands (m, world)
/// @param current joints of the arm (rad)
/// @param reach answers whether the arm can take a view
/// @param band the distance and its limits; its target and direction are ignored
/// @param skip how many of the reachable views to skip, in order of rising angle from frontal
std::optional<ReachableView> first_view(const Aabb& volume, const Eigen::Vector3d& robot, const Joints& current,
                                        const Reach& reach, ViewRequest band, int skip = 0);

}  // namespace agrisee::plan
