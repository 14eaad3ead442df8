// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The straight approach of a gripper to a fruit: its parameters, the space that it sweeps, and the question whether an
/// arm can follow it. World frame, metres.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/ellipsoid.hpp>
#include <agrisee/result.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace agrisee::plan {

/// Parameters of plan_picking and of the UR3's answer to it.
struct PickingParameters {
  bool enabled = true;             ///< plan the picking at the end of a scan
  double stand_off = 0.12;         ///< from the body's surface to the tool at the pre-grasp pose (m)
  double contact = 0.0;            ///< the approach ends this far before the surface (m); negative: inside the body
  double gripper_radius = 0.02;    ///< of the capsule that the gripper sweeps, margin included (m)
  double tool_length = 0.0;        ///< the gripping point lies this far ahead of the optical frame along its z (m)
  double pedicel_angle = deg(40);  ///< no approach from within this angle about the growth axis (rad)
  int directions = 300;            ///< spread over the sphere
  int rolls = 12;                  ///< about the direction, evenly spaced
  int steps = 4;                   ///< along the straight approach
  double max_joint_step = 1.0;     ///< from one of them to the next (rad); more is another posture, not a movement
  double depth_tie = 0.02;         ///< fruit whose depths differ by less are picked by the arm's shortest moves (m)
  double front_weight = 1.0;       ///< preference for approaches from the robot's side
  double across_weight = 1.0;      ///< for approaches across the growth axis, which leave the pedicel free
  double seen_weight = 1.0;        ///< for sides that were observed
  double away_weight = 1.0;        ///< for sides where no neighbour is

  /// The paper plans no picking.
  static PickingParameters paper() {
    PickingParameters p;
    p.enabled = false;
    return p;
  }
  /// @throws ParameterError naming the field that is out of range
  void check() const {
    const auto finite = [](double x, double least) { return x >= least && std::isfinite(x); };
    check_parameter(finite(stand_off, 0.0), "picking.stand_off", ">= 0", stand_off);
    check_parameter(std::isfinite(contact) && contact <= stand_off, "picking.contact", "at most picking.stand_off",
                    contact);
    check_parameter(finite(gripper_radius, 0.0), "picking.gripper_radius", ">= 0", gripper_radius);
    check_parameter(finite(tool_length, 0.0), "picking.tool_length", ">= 0", tool_length);
    check_parameter(pedicel_angle >= 0 && pedicel_angle <= 0.5 * kPi, "picking.pedicel_angle", "in [0, pi/2]",
                    pedicel_angle);
    check_parameter(directions >= 6, "picking.directions", ">= 6", directions);
    check_parameter(rolls >= 1, "picking.rolls", ">= 1", rolls);
    check_parameter(steps >= 1, "picking.steps", ">= 1", steps);
    check_parameter(max_joint_step > 0, "picking.max_joint_step", "positive", max_joint_step);
    check_parameter(finite(depth_tie, 0.0), "picking.depth_tie", ">= 0", depth_tie);
    check_parameter(std::isfinite(front_weight), "picking.front_weight", "finite", front_weight);
    check_parameter(std::isfinite(across_weight), "picking.across_weight", "finite", across_weight);
    check_parameter(std::isfinite(seen_weight), "picking.seen_weight", "finite", seen_weight);
    check_parameter(std::isfinite(away_weight), "picking.away_weight", "finite", away_weight);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("enabled", p.enabled);
    f("stand_off", p.stand_off);
    f("contact", p.contact);
    f("gripper_radius", p.gripper_radius);
    f("tool_length", p.tool_length);
    f("pedicel_angle", p.pedicel_angle);
    f("directions", p.directions);
    f("rolls", p.rolls);
    f("steps", p.steps);
    f("max_joint_step", p.max_joint_step);
    f("depth_tie", p.depth_tie);
    f("front_weight", p.front_weight);
    f("across_weight", p.across_weight);
    f("seen_weight", p.seen_weight);
    f("away_weight", p.away_weight);
  }
};

/// The gripper's way towards a fruit along `direction` (unit): from the pre-grasp position, and as far behind it as the
/// gripper is long, to the centre.
inline Capsule swept_gripper(const OrientedEllipsoid& fruit, const Eigen::Vector3d& direction,
                             const PickingParameters& p) {
  const double surface = 1.0 / (fruit.axes.transpose() * direction).cwiseQuotient(fruit.radii).norm();
  return {fruit.center - (surface + p.stand_off + p.tool_length) * direction, fruit.center, p.gripper_radius};
}

/// Whether a capsule overlaps an ellipsoid; spheres within and about it give the first answer.
inline bool meets(const Capsule& capsule, const OrientedEllipsoid& e) {
  const double apart = segment_distance(capsule.a, capsule.b, e.center, e.center);
  if (apart >= capsule.radius + e.radii.maxCoeff()) return false;
  if (apart < capsule.radius + e.radii.minCoeff() - kTouch) return true;
  return distance(e, capsule.a, capsule.b) < capsule.radius - kTouch;
}

/// A wish to approach a fruit: the tool's origin moves straight from `start` to `end` along `direction`, its z axis
/// along it, its roll free but the same all the way. World, metres.
struct ApproachRequest {
  Eigen::Vector3d direction;                     ///< unit
  Eigen::Vector3d start;                         ///< of the tool at the pre-grasp pose
  Eigen::Vector3d end;                           ///< of the tool at the end of the approach
  const std::vector<KeepOut>& keep_out;          ///< that count for this fruit
  const std::vector<OrientedEllipsoid>& others;  ///< the other fruit that hang there
};

/// An approach that an arm can follow.
struct ReachableApproach {
  Pose world_T_pre_grasp = Pose::Identity();  ///< of the tool
  std::optional<Joints> joints;               ///< absent where the caller moves without telling
};

/// The answer to a wish: how, or why not. Of the reasons only `arm_meets_fruit` may go away when other fruit are
/// picked.
struct ApproachAnswer {
  std::optional<ReachableApproach> reached;            ///< how; empty when it cannot be followed
  PickingReason reason = PickingReason::out_of_reach;  ///< why not
};

/// Answers a wish for an arm that comes from `current`. It has to give the same answer to the same question.
using ReachApproach = std::function<ApproachAnswer(const ApproachRequest&, const Joints& current)>;

}  // namespace agrisee::plan
