// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Directions from which a fruit may be approached, the best first. World frame, metres.
#pragma once

#include <agrisee/pick/picking.hpp>

#include <vector>

namespace agrisee::pick {

/// A direction of approach.
struct RankedDirection {
  Eigen::Vector3d direction;  // unit vector, along which the gripper moves
  double crossed = 0.0;       // measured surface that the gripper would cross (m2)
};

/// What the directions are scored by, besides the places of the fruit.
struct Preferences {
  Eigen::Vector3d growth_axis;              // unit vector
  const SeenDirections* seen;               // null: not known
  const std::vector<SurfacePiece>& pieces;  // of the surroundings
};

/// Directions of approach to a fruit, best first. A direction scores by how far it comes from the robot's side, across
/// the growth axis, away from the other fruit, towards the observed surface, and through little of the surroundings;
/// those near the pedicel are left out.
/// @param fruit, others the space that they take up
/// @param robot where the robot's base stands (m)
std::vector<RankedDirection> ranked_directions(const OrientedEllipsoid& fruit,
                                               const std::vector<OrientedEllipsoid>& others, const Preferences& by,
                                               const Eigen::Vector3d& robot, const PickingParameters& parameters);

}  // namespace agrisee::pick
