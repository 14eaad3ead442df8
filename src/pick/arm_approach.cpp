// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/collision.hpp>
#include <agrisee/arm/ur.hpp>
#include <agrisee/pick/arm_approach.hpp>
#include <agrisee/plan/arm_reach.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::pick {

bool meets_any(const Joints& q, const arm::Mount& mount, const std::vector<OrientedEllipsoid>& ellipsoids) {
  const auto pieces = arm::pieces_in_world(q, mount);
  for (const OrientedEllipsoid& ellipsoid : ellipsoids) {
    const double size = ellipsoid.radii.maxCoeff();
    for (const arm::Piece& piece : pieces) {
      const double reach = 0.5 * (piece.capsule.b - piece.capsule.a).norm() + piece.capsule.radius + size;
      if (piece.part == arm::Part::base || (piece.cylinder.center - ellipsoid.center).squaredNorm() > reach * reach)
        continue;
      if (meets(piece.capsule, ellipsoid) && overlap(piece.cylinder, ellipsoid)) return true;
    }
  }
  return false;
}

namespace {

/// The straight approach of one request, for an arm.
struct StraightApproach {
  const arm::Mount& mount;  // with the keep-out spaces that apply to the fruit
  const Pose& base_T_world;
  const Pose& tool_T_tool0;
  const ApproachRequest& request;
  const PickingParameters& parameters;

  /// Rotation of the tool about the direction of approach (rad), for a roll in [0, parameters.rolls).
  double roll_angle(int roll) const { return kTwoPi * roll / parameters.rolls; }
  /// base_link_T_tool0 with the tool's origin at `position` (m, world).
  Pose tool0_at(const Eigen::Vector3d& position, int roll) const {
    return base_T_world * look_along(position, request.direction, roll_angle(roll)) * tool_T_tool0;
  }
  /// What the arm collides with at joint angles `q`; `reachable` when nothing.
  PickingReason collision(const Joints& q) const {
    if (arm::collides(q, mount)) return PickingReason::arm_collision;
    return meets_any(q, mount, request.others) ? PickingReason::arm_meets_fruit : PickingReason::reachable;
  }
  /// Why the arm cannot follow the line from joint angles `q` at its start; `reachable` when it can.
  /// @param limited set where the limits of joint 6 change what the arm does
  PickingReason follow(Joints q, int roll, bool& limited) const {
    constexpr int kHalvings = 4;
    PickingReason reason = collision(q);
    for (int step = 1; step <= parameters.steps && reason == PickingReason::reachable; ++step) {
      throw_if_cancelled();
      reason = advance(q, static_cast<double>(step - 1) / parameters.steps,
                       static_cast<double>(step) / parameters.steps, roll, kHalvings, limited);
    }
    return reason;
  }

 private:
  /// The solution nearest to joint angles `q` within limits, if it turns all joints by less than a step may.
  std::optional<Joints> nearest_of(const arm::Solutions& solutions, const Joints& q,
                                   const arm::JointLimits& limits) const {
    std::optional<Joints> nearest;
    double least = parameters.max_joint_step;
    for (const Joints& solution : solutions) {
      const auto near = arm::nearest(solution, q, limits);
      if (!near) continue;
      const double turn = (*near - q).cwiseAbs().maxCoeff();
      if (turn < least) least = turn, nearest = near;
    }
    return nearest;
  }
  /// Whether the arm would do something else than go from joint angles `q` to `next` if joint 6 had no limits.
  bool limited_by_joint_6(const arm::Solutions& solutions, const Joints& q, const std::optional<Joints>& next) const {
    arm::JointLimits limits = mount.model.limits;
    if (q[5] - kPi >= limits.min[5] && q[5] + kPi <= limits.max[5]) return false;  // no angle is farther away
    limits.min[5] = q[5] - kTwoPi;
    limits.max[5] = q[5] + kTwoPi;
    return nearest_of(solutions, q, limits) != next;
  }
  /// Follows the line from joint angles `q`, at the share `from` of it, to the share `to`, where it leaves `q`. Where a
  /// joint turns far, the way is halved: what turns less and less is a motion along the line, what does not is another
  /// posture with the same tool pose, to which the arm cannot get on the line.
  PickingReason advance(Joints& q, double from, double to, int roll, int halvings, bool& limited) const {
    constexpr double kContinuous = 0.2;  // rad
    const Eigen::Vector3d position = request.start + to * (request.end - request.start);
    const arm::Solutions solutions = arm::solve(tool0_at(position, roll), q[5], mount.model);
    const std::optional<Joints> next = nearest_of(solutions, q, mount.model.limits);
    limited = limited || limited_by_joint_6(solutions, q, next);
    if (!next) return PickingReason::approach_interrupted;
    if ((*next - q).cwiseAbs().maxCoeff() > kContinuous) {
      if (halvings == 0) return PickingReason::approach_interrupted;
      const double middle = 0.5 * (from + to);
      const PickingReason reason = advance(q, from, middle, roll, halvings - 1, limited);
      return reason == PickingReason::reachable ? advance(q, middle, to, roll, halvings - 1, limited) : reason;
    }
    q = *next;
    const PickingReason here = collision(q);
    return here == PickingReason::reachable || here == PickingReason::arm_meets_fruit
               ? here
               : PickingReason::approach_interrupted;
  }
};

/// Joint angles for the start of an approach.
struct StartPosture {
  Joints joints;      // rad
  double time, turn;  // of the move there: s, and rad in joint space
  int roll, group;    // postures of a group differ in joint 6 alone
};

/// Answers approach requests for a mounted arm.
class ArmApproach {
 public:
  ArmApproach(const arm::Mount& mount, const Pose& tool0_T_tool, const PickingParameters& parameters)
      : mount_(mount),
        base_T_world_(mount.world_T_base.inverse()),
        tool_T_tool0_(tool0_T_tool.inverse()),
        parameters_(parameters),
        symmetric_(arm::on_last_axis(tool0_T_tool) && arm::on_last_axis(mount.tool0_T_optical) &&
                   tool0_T_tool.linear()(2, 2) > 0.0) {}

  ApproachAnswer operator()(const ApproachRequest& request, const Joints& current) const {
    arm::Mount mount = mount_;
    mount.keep_out = request.keep_out;
    const StraightApproach approach{mount, base_T_world_, tool_T_tool0_, request, parameters_};
    int groups = 0;
    const std::vector<StartPosture> postures = start_postures(approach, current, groups);
    if (postures.empty()) return {std::nullopt, PickingReason::out_of_reach};
    std::vector<char> rejected(static_cast<std::size_t>(groups), 0);
    PickingReason farthest = PickingReason::arm_collision;
    for (const StartPosture& p : postures) {
      if (rejected[static_cast<std::size_t>(p.group)]) continue;
      bool limited = false;
      const PickingReason reason = approach.follow(p.joints, p.roll, limited);
      if (reason == PickingReason::reachable)
        return {ReachableApproach{look_along(request.start, request.direction, approach.roll_angle(p.roll)), p.joints},
                PickingReason::reachable};
      if (!limited) rejected[static_cast<std::size_t>(p.group)] = 1;  // then the others fail as well
      farthest = std::max(farthest, reason);
    }
    return {std::nullopt, farthest};
  }

 private:
  /// All joint angles within the limits that put the tool at the start, over all rolls; soonest reached first.
  /// Adds the number of their groups to `groups`.
  std::vector<StartPosture> start_postures(const StraightApproach& approach, const Joints& current, int& groups) const {
    std::vector<StartPosture> postures;
    const arm::JointLimits& limits = approach.mount.model.limits;
    const auto add = [&](const Joints& q, int roll, int group) {
      if (const auto near = arm::nearest(q, current, limits))
        postures.push_back(
            {*near, arm::move_time(current, *near, limits), arm::joint_distance(current, *near), roll, group});
    };
    const Eigen::Vector3d& start = approach.request.start;
    if (symmetric_) {
      for (const Joints& q : arm::solve(approach.tool0_at(start, 0), current[5], mount_.model)) {
        for (int roll = 0; roll < parameters_.rolls; ++roll) {
          Joints rolled = q;
          rolled[5] += approach.roll_angle(roll);
          add(rolled, roll, groups);
        }
        ++groups;
      }
    } else {
      for (int roll = 0; roll < parameters_.rolls; ++roll)
        for (const Joints& q : arm::solve(approach.tool0_at(start, roll), current[5], mount_.model))
          add(q, roll, groups++);
    }
    std::stable_sort(postures.begin(), postures.end(), [](const StartPosture& a, const StartPosture& b) {
      return a.time != b.time ? a.time < b.time : a.turn < b.turn;
    });
    return postures;
  }

  arm::Mount mount_;
  Pose base_T_world_, tool_T_tool0_;
  PickingParameters parameters_;
  /// Tool and sensor are on the axis of the last joint. A roll then turns that joint alone: the solutions of one roll
  /// give those of all rolls, and they all collide with the same things.
  bool symmetric_;
};

}  // namespace

ReachApproach approach_of(arm::Mount mount, const Pose& tool0_T_tool, const PickingParameters& parameters) {
  mount.check();
  parameters.check();
  check_input(is_rigid(tool0_T_tool), "approach_of: tool0_T_tool is not finite or not a rigid pose");
  mount.keep_out.clear();
  return ArmApproach(mount, tool0_T_tool, parameters);
}

ReachApproach approach_of(const Workcell& workcell, const PickingParameters& parameters) {
  if (workcell.tool0_T_tool) return approach_of(plan::mount_of(workcell), *workcell.tool0_T_tool, parameters);
  const Pose tool0_T_tool = workcell.tool0_T_optical * Eigen::Translation3d(0.0, 0.0, parameters.tool_length);
  return approach_of(plan::mount_of(workcell), tool0_T_tool, parameters);
}

}  // namespace agrisee::pick
