// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Collisions of a UR3 and its sensor with forbidden spaces and with themselves.
///
/// Each link is a union of flat-ended cylinders in its link frame. They were fitted around the collision meshes of the
/// robot's published description (Universal_Robots_ROS2_Description, BSD-3): they enclose the meshes completely and
/// protrude by a few millimetres at most. The shoulder offset (0.1198 m) of the upper arm and the elbow offset (0.0275
/// m) of the forearm, both along the joints' axes, are part of the z coordinates. Each cylinder is enclosed by a
/// capsule for a quick test. The cylinders are tested only if the capsules overlap, since the round ends of a capsule
/// protrude 2 to 3 cm beyond the flat cap of a joint.
///
/// The links from the shoulder to wrist 3 and the housing of the sensor are tested against the forbidden spaces. The
/// base is not, since it stands on something. Links are tested against each other unless they are adjacent or can never
/// meet. World frame, metres. Takes 1 to 3 us per posture.
#pragma once

#include <agrisee/arm/mount.hpp>
#include <agrisee/arm/ur3.hpp>
#include <agrisee/geometry/overlap.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace agrisee::arm {

/// The bodies that may collide. The six links are in the order of LinkFrames.
enum class Part { shoulder, upper_arm, forearm, wrist_1, wrist_2, wrist_3, base, sensor };

/// The name of a part, as messages use it.
inline std::string_view to_string(Part part) {
  constexpr std::array<std::string_view, 8> names{"shoulder", "upper_arm", "forearm", "wrist_1",
                                                  "wrist_2",  "wrist_3",   "base",    "sensor"};
  return names[static_cast<std::size_t>(part)];
}

/// One of the solids that make up a part: a flat-ended cylinder and the capsule that encloses it.
struct Piece {
  Part part = Part::shoulder;  ///< the part to which it belongs
  OrientedCylinder cylinder;   ///< in the frame of the part, or in world
  Capsule capsule;             ///< encloses the cylinder; in the same frame
};

/// Makes the piece with a cylinder of this radius (m) from a to b (m).
inline Piece make_piece(Part part, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
  const OrientedCylinder cylinder{0.5 * (a + b), (b - a).normalized(), radius, (b - a).norm()};
  return {part, cylinder, enclosing_capsule(cylinder)};
}

/// The pieces of the links from the shoulder to wrist 3 in their link frames, then that of the base in base_link,
/// without the connector.
inline const std::array<Piece, 15>& ur3_pieces() {
  static const std::array<Piece, 15> pieces{
      make_piece(Part::shoulder, {0.0, 0.0, -0.0665}, {0.0, 0.0, 0.0575}, 0.0525),
      make_piece(Part::shoulder, {0.0, -0.0545, 0.0}, {0.0, -0.026, 0.0}, 0.046),
      make_piece(Part::upper_arm, {0.0, 0.0, 0.0535}, {0.0, 0.0, 0.1775}, 0.0525),
      make_piece(Part::upper_arm, {-0.0885, 0.0, 0.12}, {-0.0255, 0.0, 0.12}, 0.0465),
      make_piece(Part::upper_arm, {-0.2215, 0.0, 0.12}, {-0.0885, 0.0, 0.12}, 0.039),
      make_piece(Part::upper_arm, {ur3::a2, 0.0, 0.069}, {ur3::a2, 0.0, 0.1775}, 0.044),
      make_piece(Part::forearm, {0.0, 0.0, 0.0115}, {0.0, 0.0, 0.079}, 0.042),
      make_piece(Part::forearm, {-0.2005, 0.0, 0.0275}, {0.003, 0.0, 0.0275}, 0.0355),
      make_piece(Part::forearm, {ur3::a3, 0.0, -0.0195}, {ur3::a3, 0.0, 0.0705}, 0.0345),
      make_piece(Part::wrist_1, {0.0, -0.043, 0.0}, {0.0, 0.047, 0.0}, 0.037),
      make_piece(Part::wrist_1, {0.0, 0.0, -0.047}, {0.0, 0.0, -0.018}, 0.033),
      make_piece(Part::wrist_2, {0.0, -0.0485, 0.0}, {0.0, 0.041, 0.0}, 0.0365),
      make_piece(Part::wrist_2, {0.0, 0.0, -0.047}, {0.0, 0.0, -0.0175}, 0.0345),
      make_piece(Part::wrist_3, {0.0, 0.0, -0.042}, {0.0, 0.0, -0.001}, 0.0365),
      make_piece(Part::base, {0.0, 0.0, -0.001}, {0.0, 0.0, 0.0865}, 0.0655),
  };
  return pieces;
}

/// A collision: two things that overlap.
struct Contact {
  Part part = Part::shoulder;  ///< the part that collides
  std::string_view with;       ///< the name of a part or of a forbidden space; valid as long as the Mount exists
};

namespace detail {

/// True if two parts, a before b in the order of Part, have to be tested against each other. Not tested are adjacent
/// parts (the sensor is part of wrist 3) and pairs that cannot meet at any joint angles: upper arm and base, forearm
/// and wrist 2, wrist 1 and wrist 3.
constexpr bool may_meet(Part a, Part b) {
  switch (a) {
    case Part::shoulder:
      return b >= Part::forearm && b != Part::base;
    case Part::upper_arm:
      return b >= Part::wrist_1 && b != Part::base;
    case Part::forearm:
      return b >= Part::wrist_3;
    case Part::wrist_1:
      return b >= Part::base;
    case Part::wrist_2:
    case Part::wrist_3:
      return b == Part::base;
    case Part::base:
      return b == Part::sensor;
    case Part::sensor:
      return false;
  }
  return false;
}

}  // namespace detail

/// The name of the first forbidden space that the housing of a sensor at world_T_optical overlaps, or nothing. The roll
/// of the sensor does not matter.
inline std::optional<std::string_view> sensor_collision(const Pose& world_T_optical, const Mount& mount) {
  const OrientedCylinder body = housing(mount.sensor, world_T_optical);
  for (const KeepOut& space : mount.keep_out)
    if (overlap(body, space)) return space.name;
  return std::nullopt;
}

/// The pieces of the arm at joint angles `q` (rad) and of its sensor, in world: shoulder to wrist 3, base, sensor.
/// @throws InputError if a joint angle is not finite
inline std::array<Piece, 16> pieces_in_world(const Joints& q, const Mount& mount) {
  std::array<Pose, 8> world_T_part;  // in the order of Part; that of the sensor is not used
  const LinkFrames frames = link_frames(q);
  for (std::size_t i = 0; i < frames.size(); ++i) world_T_part[i] = mount.world_T_base * frames[i];
  world_T_part[static_cast<std::size_t>(Part::base)] = mount.world_T_base;
  std::array<Piece, 16> out;
  const auto& pieces = ur3_pieces();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Pose& pose = world_T_part[static_cast<std::size_t>(pieces[i].part)];
    out[i] = pieces[i];
    out[i].cylinder.center = pose * pieces[i].cylinder.center;
    out[i].cylinder.axis = pose.linear() * pieces[i].cylinder.axis;
    out[i].capsule.a = pose * pieces[i].capsule.a;
    out[i].capsule.b = pose * pieces[i].capsule.b;
  }
  const OrientedCylinder body = housing(mount.sensor, world_T_part[5] * mount.tool0_T_optical);
  out.back() = {Part::sensor, body, enclosing_capsule(body)};
  return out;
}

/// The first collision of the arm at joint angles `q` (rad), or nothing. Forbidden spaces are tested first, in their
/// order, then the parts of the arm against each other.
/// @throws InputError if a joint angle is not finite
inline std::optional<Contact> find_collision(const Joints& q, const Mount& mount) {
  const auto pieces = pieces_in_world(q, mount);
  for (const KeepOut& space : mount.keep_out) {
    const Piece* hit = std::visit(
        [&](const auto& shape) {
          const auto it = std::find_if(pieces.begin(), pieces.end(), [&](const Piece& p) {
            return p.part != Part::base && overlap(p.capsule, shape) && overlap(p.cylinder, shape);
          });
          return it == pieces.end() ? nullptr : &*it;
        },
        space.shape);
    if (hit) return Contact{hit->part, space.name};
  }
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (std::size_t j = i + 1; j < pieces.size(); ++j) {
      const Piece &a = pieces[i], &b = pieces[j];
      if (detail::may_meet(a.part, b.part) && overlap(a.capsule, b.capsule) && overlap(a.cylinder, b.cylinder))
        return Contact{a.part, to_string(b.part)};
    }
  return std::nullopt;
}

/// True if the arm at joint angles `q` (rad) overlaps a forbidden space or itself.
inline bool collides(const Joints& q, const Mount& mount) { return find_collision(q, mount).has_value(); }

}  // namespace agrisee::arm
