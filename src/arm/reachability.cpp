// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/reachability.hpp>

#include <array>
#include <cmath>

namespace agrisee::arm {

std::vector<double> distances_to_try(const ReachParameters& p) {
  std::vector<double> out{p.distance};
  double up = p.distance, down = p.distance;
  for (int i = 1; up < p.distance_max || down > p.distance_min; ++i) {
    if (up < p.distance_max) out.push_back(up = std::min(p.distance + i * p.distance_step, p.distance_max));
    if (down > p.distance_min) out.push_back(down = std::max(p.distance - i * p.distance_step, p.distance_min));
  }
  return out;
}

namespace {

// Joint angles for one of several alternative sensor poses.
struct Candidate {
  Joints joints;
  double time = 0.0, turn = 0.0;  // move time (s) and joint distance (rad) from the present joints
  int pose = 0;                   // number of the sensor pose
};

Candidate candidate(const Mount& mount, const Joints& present, const Joints& q, int pose) {
  return {q, move_time(present, q, mount.model.limits), joint_distance(present, q), pose};
}

// Appends all solutions for a pose of the tool, each at the joint angles nearest to the present ones.
void add_solutions(const Mount& mount, const Pose& base_T_tool0, const Joints& present, int pose,
                   std::vector<Candidate>& out) {
  for (const Joints& q : solve(base_T_tool0, present[5], mount.model))
    if (const auto near = nearest(q, present, mount.model.limits))
      out.push_back(candidate(mount, present, *near, pose));
}

// The sense in which the view rolls when the last joint turns: +1 or -1 if the optical axis is the axis of that joint,
// otherwise 0; then a different roll needs a different posture of the whole arm.
int roll_of_last_joint(const Mount& mount) {
  if (!on_last_axis(mount.tool0_T_optical)) return 0;
  return mount.tool0_T_optical.linear()(2, 2) > 0.0 ? 1 : -1;
}

// A roll of a sensor on the axis of the last joint, and that joint's angle (rad).
struct Roll {
  int number;
  double angle;
};

// Of `rolls` evenly spaced rolls the one for which the last joint turns least; the first of several. Nothing if none
// lies within the limits.
// @param upright,present the last joint's angle without roll, and now (rad)
// @param sense as returned by roll_of_last_joint; not 0
std::optional<Roll> nearest_roll(double upright, double present, int sense, int rolls, const JointLimits& limits) {
  std::optional<Roll> best;
  const auto turn = [&](double angle) { return std::abs(angle - present); };
  const auto try_roll = [&](int i) {
    const auto angle = nearest(wrap(upright + sense * kTwoPi * i / rolls), present, limits.min[5], limits.max[5]);
    if (angle && (!best || turn(*angle) < turn(best->angle))) best = Roll{i, *angle};
  };
  // The roll next to the present angle and its two neighbors; all others are 1.5 steps away or more.
  const double step = kTwoPi / rolls;
  const int at = static_cast<int>(std::lround(wrap(sense * (present - upright)) / step)) + rolls;
  std::array<int, 3> next{(at - 1) % rolls, at % rolls, (at + 1) % rolls};
  std::sort(next.begin(), next.end());
  for (const int i : next) try_roll(i);
  if (best && turn(best->angle) < 1.4 * step) return best;
  best.reset();
  for (int i = 0; i < rolls; ++i) try_roll(i);  // the limits are in the way
  return best;
}

// Appends the solutions for `rolls` evenly spaced rolls of a sensor on the axis of the last joint. The rolls of a
// solution differ in that joint alone and collide with the same things, so only the one with the shortest turn is
// appended.
// @param sense as returned by roll_of_last_joint; not 0
// @return false, and nothing is appended, at a wrist singularity, where other joints move as well
bool add_rolled_solutions(const Mount& mount, const Pose& base_T_tool0, const Joints& present, int sense, int rolls,
                          std::vector<Candidate>& out) {
  const std::size_t before = out.size();
  bool regular = true;
  for (const Joints& q : solve(base_T_tool0, present[5], mount.model)) {
    if (!(std::abs(std::sin(q[4])) > 1e-6)) regular = false;
    const auto roll = nearest_roll(q[5], present[5], sense, rolls, mount.model.limits);
    if (!roll) continue;
    Joints turned = q;
    turned[5] = roll->angle;
    if (const auto near = nearest(turned, present, mount.model.limits))
      out.push_back(candidate(mount, present, *near, roll->number));
  }
  if (!regular) out.resize(before);
  return regular;
}

// The first candidate without collisions, in the order of move time, joint distance, sensor pose and position in
// `candidates`; nothing if all collide. Sorts the candidates.
std::optional<Candidate> first_free(std::vector<Candidate>& candidates, const Mount& mount) {
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.time != b.time ? a.time < b.time : a.turn != b.turn ? a.turn < b.turn : a.pose < b.pose;
  });
  for (const Candidate& c : candidates)
    if (!collides(c.joints, mount)) return c;
  return std::nullopt;
}

}  // namespace

std::optional<Reached> reach(const Mount& mount, const Joints& present, const Pose& world_T_optical) {
  mount.check();
  check_input(present.allFinite(), "reach: a present joint angle is not finite");
  check_input(is_rigid(world_T_optical), "reach: world_T_optical is not finite or not a rigid pose");
  if (sensor_collision(world_T_optical, mount)) return std::nullopt;
  std::vector<Candidate> candidates;
  add_solutions(mount, mount.world_T_base.inverse() * world_T_optical * mount.tool0_T_optical.inverse(), present, 0,
                candidates);
  const auto best = first_free(candidates, mount);
  if (!best) return std::nullopt;
  return Reached{best->joints, world_T_optical, 0.0, best->time};
}

std::optional<Reached> reach(const Mount& mount, const Joints& present, const Eigen::Vector3d& target,
                             const Eigen::Vector3d& direction, const ReachParameters& parameters) {
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
  const int sense = roll_of_last_joint(mount);
  std::vector<Candidate> candidates;
  for (const double distance : distances_to_try(parameters)) {
    upright.translation() = target - distance * ahead;
    candidates.clear();
    const Pose base_T_tool0 = base_T_world * upright * optical_T_tool0;
    if (sense == 0 || !add_rolled_solutions(mount, base_T_tool0, present, sense, parameters.rolls, candidates))
      for (int i = 0; i < parameters.rolls; ++i)
        add_solutions(mount, base_T_world * rolled(i) * optical_T_tool0, present, i, candidates);
    if (candidates.empty() || sensor_collision(upright, mount)) continue;
    if (const auto best = first_free(candidates, mount))
      return Reached{best->joints, rolled(best->pose), distance, best->time};
  }
  return std::nullopt;
}

}  // namespace agrisee::arm
