// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/collision.hpp>

namespace agrisee::arm {

namespace {

// True if two parts, a before b in the order of Part, have to be tested against each other. Not tested are adjacent
// parts (the sensor is fixed to wrist 3) and pairs that cannot meet at any joint angles: upper arm and base, forearm
// and wrist 2, wrist 1 and wrist 3.
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
      return b >= Part::base;
    case Part::wrist_3:
      return b == Part::base;
    case Part::base:
      return b == Part::sensor;
    case Part::sensor:
      return false;
  }
  return false;
}

}  // namespace

std::optional<std::string_view> sensor_collision(const Pose& world_T_optical, const Mount& mount) {
  const OrientedCylinder body = housing(mount.sensor, world_T_optical);
  for (const KeepOut& space : mount.keep_out)
    if (overlap(body, space)) return space.name;
  return std::nullopt;
}

std::array<Piece, 16> pieces_in_world(const Joints& q, const Mount& mount) {
  std::array<Pose, 8> world_T_part;  // in the order of Part; that of the sensor is not used
  const LinkFrames frames = link_frames(q, mount.model);
  for (std::size_t i = 0; i < frames.size(); ++i) world_T_part[i] = mount.world_T_base * frames[i];
  world_T_part[static_cast<std::size_t>(Part::base)] = mount.world_T_base;
  std::array<Piece, 16> out;
  const auto& pieces = mount.model.pieces;
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

std::optional<Contact> find_collision(const Joints& q, const Mount& mount) {
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
      if (may_meet(a.part, b.part) && overlap(a.capsule, b.capsule) && overlap(a.cylinder, b.cylinder))
        return Contact{a.part, to_string(b.part)};
    }
  return std::nullopt;
}

bool collides(const Joints& q, const Mount& mount) { return find_collision(q, mount).has_value(); }

}  // namespace agrisee::arm
