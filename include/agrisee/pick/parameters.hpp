// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of picking. Metres, radians.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/types.hpp>

namespace agrisee::pick {

/// Parameters of plan_picking and of the test whether the arm can follow an approach (arm_approach.hpp).
struct PickingParameters {
  static constexpr double kNoLimit = 10.0;  ///< a `max_crossed` from which on there is no limit (m2)

  bool enabled = true;             ///< plan the picking at the end of a scan
  double stand_off = 0.12;         ///< distance of the tool from the body's surface at the pre-grasp pose (m)
  double contact = 0.0;            ///< the approach ends this far before the surface (m); negative: inside the body
  double gripper_radius = 0.02;    ///< radius of the capsule that the gripper sweeps, safety margin included (m)
  double tool_length = 0.0;        ///< length of the gripper behind the gripping point (m). Without a tool frame
                                   ///< (Workcell::tool0_T_tool) it is also the distance of that point from the camera
  double pedicel_angle = deg(40);  ///< approaches within this angle of the growth axis are excluded (rad)
  int directions = 300;            ///< number of directions that are tried, spread over the sphere
  int rolls = 12;                  ///< number of rolls about each direction, evenly spaced
  int steps = 4;                   ///< number of postures that are tested along the straight approach
  double max_joint_step = 1.0;     ///< largest change of a joint from one of these postures to the next (rad)
  double depth_tie = 0.02;     ///< among fruit whose depths differ by less, the shortest move of the arm decides (m)
  double front_weight = 1.0;   ///< preference for approaches from the robot's side
  double across_weight = 1.0;  ///< preference for approaches across the growth axis, which leave the pedicel free
  double seen_weight = 1.0;    ///< preference for sides of the fruit that were observed
  double away_weight = 1.0;    ///< preference for sides of the fruit without neighbors
  double clear_weight = 2.0;   ///< preference for approaches that cross little of what was measured beside the fruit;
                               ///< 0: it does not matter
  double max_crossed = kNoLimit;  ///< largest measured surface beside the fruit that an approach may cross (m2);
                                  ///< kNoLimit or more: no limit

  /// For the stages of [1], which plan no picking: disabled.
  static PickingParameters paper() {
    PickingParameters p;
    p.enabled = false;
    return p;
  }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("enabled", p.enabled);
    // No gripper is longer or thicker, and most lengths in millimetres are beyond.
    f("stand_off", p.stand_off, Range::between(0.0, 3.0).in_metres());
    f("contact", p.contact, Range::between(-1.0, {p.stand_off, "stand_off"}).in_metres());
    f("gripper_radius", p.gripper_radius, Range::between(0.0, 1.0).in_metres());
    f("tool_length", p.tool_length, Range::between(0.0, 3.0).in_metres());
    f("pedicel_angle", p.pedicel_angle, Range::between(0.0, {0.5 * kPi, "pi/2"}).in_radians());
    f("directions", p.directions, Range::between(6, 100000));
    f("rolls", p.rolls, Range::between(1, 3600));
    f("steps", p.steps, Range::between(1, 1000));
    f("max_joint_step", p.max_joint_step, Range::positive());
    f("depth_tie", p.depth_tie, Range::not_negative());
    f("front_weight", p.front_weight, Range::finite());
    f("across_weight", p.across_weight, Range::finite());
    f("seen_weight", p.seen_weight, Range::finite());
    f("away_weight", p.away_weight, Range::finite());
    f("clear_weight", p.clear_weight, Range::finite());
    f("max_crossed", p.max_crossed, Range::not_negative());
  }
};

}  // namespace agrisee::pick
