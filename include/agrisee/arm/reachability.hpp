// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds joint angles with which the arm can take a view: within the limits, without collisions, and those that the arm
/// reaches soonest from its present posture.
///
/// The caller gives either a full sensor pose, or a target point and a viewing direction. In the second case roll and
/// distance are free, as in the controller of [1]; with a fixed distance and roll most views would be out of a UR3's
/// reach. Only the posture is checked, not the path to it. World frame; metres, rad, seconds. A view takes a few
/// microseconds if the optical axis is the axis of the last joint, otherwise about 60 us with 24 rolls.
#pragma once

#include <agrisee/arm/collision.hpp>
#include <agrisee/core/parameter_range.hpp>

#include <algorithm>
#include <optional>
#include <vector>

namespace agrisee::arm {

/// Which distances and rolls a view may have.
struct ReachParameters {
  double distance = kViewDistance;  ///< preferred distance from the sensor to the target (m)
  double distance_min = 0.28;       ///< shortest distance (m)
  double distance_max = 0.55;       ///< longest distance (m)
  double distance_step = 0.02;      ///< step between the distances that are tried (m)
  int rolls = 24;                   ///< number of evenly spaced rolls about the optical axis that are tried

  /// The values of [1]: exactly the view distance.
  static ReachParameters paper() {
    ReachParameters p;
    p.distance_min = p.distance_max = p.distance;
    return p;
  }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// Calls f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("distance", p.distance, Range::between({p.distance_min, "distance_min"}, {p.distance_max, "distance_max"}));
    f("distance_min", p.distance_min, Range::positive());
    f("distance_max", p.distance_max, Range::finite());
    f("distance_step", p.distance_step, Range::at_least(1e-4));
    f("rolls", p.rolls, Range::at_least(1));
  }
};

/// A view that the arm can take.
struct Reached {
  Joints joints = Joints::Zero();           ///< joint angles (rad), within the limits and nearest to the present ones
  Pose world_T_optical = Pose::Identity();  ///< pose of the sensor
  double distance = 0.0;                    ///< from the sensor to the target (m); 0 if the request was a pose
  double move_time = 0.0;                   ///< duration of the move from the present joints (s), see arm::move_time
};

/// The distances to try (m): the preferred one, then alternately a step farther and a step nearer, up to the longest
/// and the shortest distance.
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

/// Joint angles for one of several alternative sensor poses.
struct Candidate {
  Joints joints;
  double time = 0.0, turn = 0.0;  // move time (s) and joint distance (rad) from the present joints
  int pose = 0;                   // number of the sensor pose
};

inline Candidate candidate(const Mount& mount, const Joints& present, const Joints& q, int pose) {
  return {q, move_time(present, q, mount.limits), joint_distance(present, q), pose};
}

/// Appends all solutions for a pose of the tool, each at the joint angles nearest to the present ones.
inline void add_solutions(const Mount& mount, const Pose& base_T_tool0, const Joints& present, int pose,
                          std::vector<Candidate>& out) {
  for_each_solution(base_T_tool0, present[5], [&](const Joints& q) {
    if (const auto near = nearest(q, present, mount.limits)) out.push_back(candidate(mount, present, *near, pose));
  });
}

/// The sense in which the view rolls when the last joint turns: +1 or -1 if the optical axis is the axis of that joint,
/// otherwise 0; then a different roll needs a different posture of the whole arm.
inline int roll_of_last_joint(const Mount& mount) {
  const Eigen::Vector3d offset = mount.tool0_T_optical.translation(), ahead = mount.tool0_T_optical.linear().col(2);
  const double off = std::max({std::abs(offset.x()), std::abs(offset.y()), std::abs(ahead.x()), std::abs(ahead.y())});
  return off < 1e-9 ? (ahead.z() > 0.0 ? 1 : -1) : 0;
}

/// Appends the solutions for `rolls` evenly spaced rolls of a sensor on the axis of the last joint. The rolls of a
/// solution differ in that joint alone and collide with the same things, so only the one with the shortest turn is
/// appended.
/// @param sense as returned by roll_of_last_joint; not 0
/// @return false, and nothing is appended, at a wrist singularity, where other joints move as well
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

/// The first candidate without collisions, in the order of move time, joint distance, sensor pose and position in
/// `candidates`; nothing if all collide. Sorts the candidates.
inline std::optional<Candidate> first_free(std::vector<Candidate>& candidates, const Mount& mount) {
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.time != b.time ? a.time < b.time : a.turn != b.turn ? a.turn < b.turn : a.pose < b.pose;
  });
  for (const Candidate& c : candidates)
    if (!collides(c.joints, mount)) return c;
  return std::nullopt;
}

}  // namespace detail

/// Joint angles that put the sensor at world_T_optical. Of all solutions without collisions it is the one that is
/// reached soonest from `present` (shortest move time, then smallest joint distance, then the order of `inverse`);
/// nothing if there is none.
/// @throws InputError if the pose is not rigid or `present` is not finite; ParameterError if the mount is invalid
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

/// Joint angles for a view of `target` (m) along `direction` (from the sensor to the target, of any length). The roll
/// is free, and the distance is free within the limits of the parameters.
///
/// Distances are tried in the order of distances_to_try, until the arm has a posture without collisions at one. Of all
/// rolls and solutions at that distance, the one that is reached soonest from `present` is returned (shortest move
/// time, then smallest joint distance, then the order of the rolls, which starts with an upright image, then that of
/// `inverse`); nothing if there is none.
/// @throws InputError if target, direction or `present` is not finite or the direction is zero; ParameterError if the
///   mount or the parameters are invalid
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
