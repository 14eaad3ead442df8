// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether and how the arm can take a view: joint angles within the limits, out of the spaces to keep out of and free
/// of self-collision, the ones that the arm reaches soonest from where it stands.
///
/// Either a full sensor pose is asked for, or a point to look at and a direction to look along, roll and distance free
/// (paper, controller; a fixed distance and roll put most views of a UR3 out of reach). The posture alone is judged,
/// not the path to it. World, metres, seconds. Cost: a few
/// microseconds for a view by a sensor on the last joint's axis, about 60 us for others with 24 rolls.
#pragma once

#include <agrisee/arm/collision.hpp>

#include <algorithm>
#include <optional>
#include <vector>

namespace agrisee::arm {

/// The freedom of a view.
struct ReachParameters {
  double distance = 0.38;       ///< preferred distance from sensor to target (m)
  double distance_min = 0.28;   ///< shortest distance (m)
  double distance_max = 0.55;   ///< longest distance (m)
  double distance_step = 0.02;  ///< between the distances that are tried (m)
  int rolls = 24;               ///< rolls about the optical axis that are tried, evenly spaced

  /// The paper's values: the view distance, held exactly.
  static ReachParameters paper() {
    ReachParameters p;
    p.distance_min = p.distance_max = p.distance;
    return p;
  }

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    check_parameter(distance_min > 0.0 && std::isfinite(distance_min), "distance_min", "positive", distance_min);
    check_parameter(distance >= distance_min, "distance", "at least distance_min", distance);
    check_parameter(distance <= distance_max, "distance", "at most distance_max", distance);
    check_parameter(std::isfinite(distance_max), "distance_max", "finite", distance_max);
    check_parameter(distance_step >= 1e-4, "distance_step", "at least 0.0001", distance_step);
    check_parameter(rolls >= 1, "rolls", "at least 1", rolls);
  }

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("distance", p.distance);
    f("distance_min", p.distance_min);
    f("distance_max", p.distance_max);
    f("distance_step", p.distance_step);
    f("rolls", p.rolls);
  }
};

/// A view that the arm can take.
struct Reached {
  Joints joints = Joints::Zero();           ///< rad, within the limits, the turns nearest to the present joints
  Pose world_T_optical = Pose::Identity();  ///< where the sensor then stands
  double distance = 0.0;                    ///< from the sensor to the target (m); 0 where a pose was asked for
  double move_time = 0.0;                   ///< from the present joints (s), see arm::move_time
};

/// The distances to try (m): the preferred one, then outward from it by steps, the farther of two first, the ends of
/// the band included.
inline std::vector<double> distances_to_try(const ReachParameters& p) {
  std::vector<double> out{p.distance};
  double up = p.distance, down = p.distance;
  for (int i = 1; up < p.distance_max || down > p.distance_min; ++i) {
    if (up < p.distance_max) out.push_back(up = std::min(p.distance + i * p.distance_step, p.distance_max));
    if (down > p.distance_min) out.push_back(down = std::max(p.distance - i * p.distance_step, p.distance_min));
  }
  return out;
}

namespace detail {

/// Joint angles for one of the sensor poses that are being compared.
struct Candidate {
  Joints joints;
  double time = 0.0, turn = 0.0;  // s and rad from the present joints
  int pose = 0;                   // which sensor pose
};

inline Candidate candidate(const Mount& mount, const Joints& present, const Joints& q, int pose) {
  return {q, move_time(present, q, mount.limits), joint_distance(present, q), pose};
}

/// Append every solution for a sensor pose, turned towards the present joints.
inline void add_solutions(const Mount& mount, const Pose& base_T_tool0, const Joints& present, int pose,
                          std::vector<Candidate>& out) {
  for_each_solution(base_T_tool0, present[5], [&](const Joints& q) {
    if (const auto near = nearest(q, present, mount.limits)) out.push_back(candidate(mount, present, *near, pose));
  });
}

/// Which way the view rolls when the last joint turns, +1 or -1; 0 for a sensor that is not on that joint's axis, where
/// another roll is another posture of the whole arm.
inline int roll_of_last_joint(const Mount& mount) {
  const Eigen::Vector3d offset = mount.tool0_T_optical.translation(), ahead = mount.tool0_T_optical.linear().col(2);
  const double off = std::max({std::abs(offset.x()), std::abs(offset.y()), std::abs(ahead.x()), std::abs(ahead.y())});
  return off < 1e-9 ? (ahead.z() > 0.0 ? 1 : -1) : 0;
}

/// The same for all of `rolls` evenly spaced rolls of a sensor on the last joint's axis (`sense` as of
/// roll_of_last_joint): that joint alone turns, and the postures collide alike, so of each solution the roll with the
/// shortest turn is kept. False, and nothing appended, at a wrist singularity, where other joints move too.
inline bool add_rolled_solutions(const Mount& mount, const Pose& base_T_tool0, const Joints& present, int sense,
                                 int rolls, std::vector<Candidate>& out) {
  const std::size_t before = out.size();
  bool regular = true;
  for_each_solution(base_T_tool0, present[5], [&](const Joints& q) {
    if (!(std::abs(std::sin(q[4])) > 1e-6)) regular = false;
    Joints turned = q;
    int roll = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < rolls; ++i) {
      const auto last =
          nearest(wrap(q[5] + sense * kTwoPi * i / rolls), present[5], mount.limits.min[5], mount.limits.max[5]);
      if (!last || !(std::abs(*last - present[5]) < least)) continue;
      least = std::abs(*last - present[5]);
      turned[5] = *last;
      roll = i;
    }
    if (roll < 0) return;
    if (const auto near = nearest(turned, present, mount.limits)) out.push_back(candidate(mount, present, *near, roll));
  });
  if (!regular) out.resize(before);
  return regular;
}

/// The candidate that collides with nothing and comes first by time, turn, sensor pose and order.
inline std::optional<Candidate> first_free(std::vector<Candidate>& candidates, const Mount& mount) {
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.time != b.time ? a.time < b.time : a.turn != b.turn ? a.turn < b.turn : a.pose < b.pose;
  });
  for (const Candidate& c : candidates)
    if (!collides(c.joints, mount)) return c;
  return std::nullopt;
}

}  // namespace detail

/// Joint angles that put the sensor at world_T_optical: of all free solutions the one soonest reached from `present`
/// (shortest move time, then least joint-space distance, then the order of `inverse`); nothing when there is none.
/// @throws InputError when the pose is not rigid or `present` is not finite, ParameterError when the mount is not sound
inline std::optional<Reached> reach(const Mount& mount, const Joints& present, const Pose& world_T_optical) {
  mount.check();
  check_input(present.allFinite(), "reach: a present joint angle is not finite");
  check_input(is_rigid(world_T_optical), "reach: world_T_optical is not finite or not a rigid pose");
  if (sensor_collision(world_T_optical, mount)) return std::nullopt;
  std::vector<detail::Candidate> candidates;
  detail::add_solutions(mount, mount.world_T_base.inverse() * world_T_optical * mount.tool0_T_optical.inverse(),
                        present, 0, candidates);
  const auto best = detail::first_free(candidates, mount);
  if (!best) return std::nullopt;
  return Reached{best->joints, world_T_optical, 0.0, best->time};
}

/// A view of `target` along `direction` (from the sensor to the target; need not be unit length), roll free and
/// distance free within the band.
///
/// Distances are tried in the order of distances_to_try; the first at which the arm can stand free is taken, and there,
/// over all rolls and solutions, the one soonest reached from `present` (shortest move time, then least joint-space
/// distance, then the order of rolls, which start with the image upright, and of `inverse`). Nothing when there is
/// none.
/// @throws InputError when target, direction or `present` is not finite or the direction zero; ParameterError when
/// mount
///   or parameters are not sound
inline std::optional<Reached> reach(const Mount& mount, const Joints& present, const Eigen::Vector3d& target,
                                    const Eigen::Vector3d& direction, const ReachParameters& parameters = {}) {
  mount.check();
  parameters.check();
  check_input(present.allFinite(), "reach: a present joint angle is not finite");
  check_input(target.allFinite(), "reach: the target is not finite");
  const Pose base_T_world = mount.world_T_base.inverse(), optical_T_tool0 = mount.tool0_T_optical.inverse();
  Pose upright = look_along(target, direction);
  const Eigen::Vector3d ahead = upright.linear().col(2);
  const auto rolled = [&](int roll) {
    Pose view = upright;
    view.rotate(Eigen::AngleAxisd(kTwoPi * roll / parameters.rolls, Eigen::Vector3d::UnitZ()));
    return view;
  };
  const int sense = detail::roll_of_last_joint(mount);
  std::vector<detail::Candidate> candidates;
  for (const double distance : distances_to_try(parameters)) {
    upright.translation() = target - distance * ahead;
    candidates.clear();
    const Pose base_T_tool0 = base_T_world * upright * optical_T_tool0;
    if (sense == 0 || !detail::add_rolled_solutions(mount, base_T_tool0, present, sense, parameters.rolls, candidates))
      for (int i = 0; i < parameters.rolls; ++i)
        detail::add_solutions(mount, base_T_world * rolled(i) * optical_T_tool0, present, i, candidates);
    if (candidates.empty() || sensor_collision(upright, mount)) continue;
    if (const auto best = detail::first_free(candidates, mount))
      return Reached{best->joints, rolled(best->pose), distance, best->time};
  }
  return std::nullopt;
}

}  // namespace agrisee::arm
