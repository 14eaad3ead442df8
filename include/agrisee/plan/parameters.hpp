// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of picking and of the evidence of free space, apart from what uses them. Metres, radians.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee::plan {

/// Parameters of the free-space tests.
struct FreeSpaceParameters {
  double margin = 0.006;   ///< a sight line must end this much behind a place to have gone through it (m), and three
                           ///< standard deviations of the cells' depths (SurfaceImage::noise) where these are more
  double min_fill = 0.85;  ///< cells without return are evidence when surfaces return at least this share of pixels
  double max_incidence = deg(50);  ///< bodies are tested where a surface would be seen at less than this (rad)
  int min_refuting = 2;  ///< a surfel goes when this many views looked through it and no more than half saw it
  double max_contradiction = 0.3;  ///< a view is discarded when it contradicts more than this share of what others saw

  /// @throws ParameterError
  void check() const {
    check_parameter(margin > 0, "free_space.margin", "positive", margin);
    check_parameter(min_fill >= 0, "free_space.min_fill", ">= 0", min_fill);
    check_parameter(max_incidence > 0 && max_incidence < kPi / 2, "free_space.max_incidence", "in (0, pi/2)",
                    max_incidence);
    check_parameter(min_refuting >= 1, "free_space.min_refuting", ">= 1", min_refuting);
    check_parameter(max_contradiction > 0 && max_contradiction <= 1, "free_space.max_contradiction", "in (0, 1]",
                    max_contradiction);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("margin", p.margin);
    f("min_fill", p.min_fill);
    f("max_incidence", p.max_incidence);
    f("min_refuting", p.min_refuting);
    f("max_contradiction", p.max_contradiction);
  }
};

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

}  // namespace agrisee::plan
