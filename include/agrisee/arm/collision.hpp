// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Collisions of an arm and its sensor with forbidden spaces and with themselves.
///
/// Each link is a union of flat-ended cylinders in its link frame. Those of the UR3 were fitted around the collision
/// meshes of the robot's published description (Universal_Robots_ROS2_Description, BSD-3): they enclose the meshes
/// completely, but for the connector at the back of the base, and protrude by a few millimetres at most. The shoulder
/// offset (0.1198 m) of the upper arm and the elbow offset (0.0275 m) of the forearm, both along the joints' axes, are
/// part of the z coordinates. Other arms have the same cylinders, stretched to their links and UrModel::thickness times
/// as wide; these are not fitted, but on the safe side. Each cylinder is enclosed by a capsule for a quick test. The
/// cylinders are tested only if the capsules overlap, since the round ends of a capsule protrude 2 to 3 cm beyond the
/// flat cap of a joint.
///
/// The links from the shoulder to wrist 3 and the housing of the sensor are tested against the forbidden spaces. The
/// base is not, since it stands on something. Links are tested against each other unless they are adjacent or can never
/// meet. World frame, metres. Takes 1 to 3 us per posture. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/arm/mount.hpp>
#include <agrisee/arm/ur.hpp>
#include <agrisee/geometry/overlap.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace agrisee::arm {

/// A collision: two things that overlap.
struct Contact {
  Part part = Part::shoulder;  ///< the part that collides
  std::string_view with;       ///< the name of a part or of a forbidden space; valid as long as the Mount exists
};

/// The name of the first forbidden space that the housing of a sensor at world_T_optical overlaps, or nothing. The roll
/// of the sensor does not matter.
std::optional<std::string_view> sensor_collision(const Pose& world_T_optical, const Mount& mount);

/// The pieces of the arm at joint angles `q` (rad) and of its sensor, in world: shoulder to wrist 3, base, sensor.
/// @throws InputError if a joint angle is not finite
std::array<Piece, 16> pieces_in_world(const Joints& q, const Mount& mount);

/// The first collision of the arm at joint angles `q` (rad), or nothing. Forbidden spaces are tested first, in their
/// order, then the parts of the arm against each other.
/// @throws InputError if a joint angle is not finite
std::optional<Contact> find_collision(const Joints& q, const Mount& mount);

/// True if the arm at joint angles `q` (rad) overlaps a forbidden space or itself.
bool collides(const Joints& q, const Mount& mount);

}  // namespace agrisee::arm
