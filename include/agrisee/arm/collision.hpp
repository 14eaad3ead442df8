// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Collisions of a UR3 and its sensor with the spaces to keep out of, and with itself.
///
/// Links are unions of flat-ended cylinders in their link frames, fitted around the collision meshes of the robot's
/// published description (Universal_Robots_ROS2_Description, BSD-3) so that they enclose these entirely and stand out
/// by some millimetres at most. The offsets of the upper arm (shoulder offset 0.1198 m) and of the forearm (elbow
/// offset 0.0275 m) along the joints' axes are in their z. A capsule about each cylinder gives the first answer; only
/// where capsules overlap the cylinders decide, since a capsule's round end would stand 2 to 3 cm out of a joint's flat
/// cap.
///
/// Links from the shoulder on and the sensor's housing are tested against the spaces; the base, which stands on
/// whatever carries it, is not. Among themselves, links are tested that are not neighbours and that can meet at all.
/// Metres, world. Cost: 1 to 3 us a posture.
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

/// Its name.
inline std::string_view to_string(Part part) {
  constexpr std::array<std::string_view, 8> names{"shoulder", "upper_arm", "forearm", "wrist_1",
                                                  "wrist_2",  "wrist_3",   "base",    "sensor"};
  return names[static_cast<std::size_t>(part)];
}

/// A piece of a part, in the part's own frame: the flat-ended cylinder and the capsule about it.
struct Piece {
  Part part = Part::shoulder;  ///< whose piece it is
  OrientedCylinder cylinder;   ///< in the part's frame
  Capsule capsule;             ///< about the cylinder
};

/// The piece that is the cylinder of this radius (m) from a to b.
inline Piece make_piece(Part part, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
  const OrientedCylinder cylinder{0.5 * (a + b), (b - a).normalized(), radius, (b - a).norm()};
  return {part, cylinder, enclosing_capsule(cylinder)};
}

/// The pieces of the links from the shoulder to wrist 3 in their link frames, then the base's in base_link (its
/// connector left out).
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

/// Two things that overlap.
struct Contact {
  Part part = Part::shoulder;  ///< the one that touches
  std::string_view with;       ///< a part or the name of a space, valid as long as the Mount
};

namespace detail {

/// Whether two parts are tested against each other, in the order of Part. Left out are neighbours (the sensor belongs
/// to wrist 3) and pairs that the arm's build keeps apart at all angles: upper arm and base, forearm and wrist 2, wrist
/// 1 and wrist 3.
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

/// The first space that the sensor's housing overlaps when it stands at world_T_optical, by name; its roll plays no
/// part.
inline std::optional<std::string_view> sensor_collision(const Pose& world_T_optical, const Mount& mount) {
  const OrientedCylinder body = housing(mount.sensor, world_T_optical);
  for (const KeepOut& space : mount.keep_out)
    if (overlap(body, space)) return space.name;
  return std::nullopt;
}

/// All pieces of the arm at joint angles `q` and of its sensor, in world: shoulder to wrist 3, the base, the sensor.
/// @throws InputError when a joint angle is not finite
inline std::array<Piece, 16> pieces_in_world(const Joints& q, const Mount& mount) {
  std::array<Pose, 8> world_T_part;  // by Part; the sensor's is not used
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

/// A collision of the arm at joint angles `q`, or nothing when it is free: spaces first, in their order, then the arm
/// with itself.
/// @throws InputError when a joint angle is not finite
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

/// Whether the arm at joint angles `q` overlaps a space to keep out of, or itself.
inline bool collides(const Joints& q, const Mount& mount) { return find_collision(q, mount).has_value(); }

}  // namespace agrisee::arm
