// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of the default planner (gain_planner.hpp) and of what it expects to see (expected_surface.hpp), apart
/// from them so that programs that only read parameters compile fast. Metres, seconds, radians.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

namespace agrisee::plan {

/// Parameters of ExpectedSurface.
struct ExpectedSurfaceParameters {
  double max_incidence = deg(75);  ///< a surface seen at less than this is expected to be measured (rad)
  int samples = 320;               ///< samples of a body's surface
  double cover_radius = 0.005;     ///< a sample with a point this near is covered (m)
  double voxel = 0.015;            ///< edge of the voxels of unknown space (m)
  double neighborhood = 0.06;      ///< unknown space counts within this distance of a body's surface (m)
  double unknown_weight = 0.08;  ///< fruit surface expected behind the face of an unknown voxel, as a share of the face
  double disappointment = 0.35;  ///< factor on samples for every view that should have shown them and did not

  /// @throws ParameterError
  void check() const {
    check_parameter(max_incidence > 0 && max_incidence < kPi / 2, "expected.max_incidence", "in (0, pi/2)",
                    max_incidence);
    check_parameter(samples >= 1 && samples <= 100000, "expected.samples", "in [1, 100000]", samples);
    check_parameter(cover_radius > 0, "expected.cover_radius", "positive", cover_radius);
    check_parameter(voxel > 0, "expected.voxel", "positive", voxel);
    check_parameter(neighborhood >= 0, "expected.neighborhood", ">= 0", neighborhood);
    check_parameter(unknown_weight >= 0, "expected.unknown_weight", ">= 0", unknown_weight);
    check_parameter(disappointment >= 0 && disappointment <= 1, "expected.disappointment", "in [0, 1]", disappointment);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("max_incidence", p.max_incidence);
    f("samples", p.samples);
    f("cover_radius", p.cover_radius);
    f("voxel", p.voxel);
    f("neighborhood", p.neighborhood);
    f("unknown_weight", p.unknown_weight);
    f("disappointment", p.disappointment);
  }
};

/// Parameters of GainPlanner.
struct GainPlannerParameters {
  int candidates = 4000;       ///< views tried, their directions spread over the whole sphere; a tenth may be in reach
  double spread = 0.6;         ///< how far from the middle of the bodies they look, as a share of the way to the border
  double distance = 0.38;      ///< of the first view from its target (m)
  double distance_min = 0.27;  ///< nearest (m)
  double distance_max = 0.55;  ///< farthest (m)
  double dwell = 1.5;          ///< time that a view costs beside the move (s): settling, exposure, computing
  int lookahead = 6;           ///< views planned ahead, so that the nearest of them comes first; 1 = none
  double patience = 0.5;       ///< but only where it scores at least this share of the best
  double min_gain = 0.0015;    ///< stop when the best view promises less than this share of the known fruit surface
  ExpectedSurfaceParameters expected;  ///< what a view is expected to show

  /// @throws ParameterError
  void check() const {
    check_parameter(candidates >= 1 && candidates <= 1000000, "planner.candidates", "in [1, 1000000]", candidates);
    check_parameter(spread >= 0 && spread <= 1, "planner.spread", "in [0, 1]", spread);
    check_parameter(distance_min > 0, "planner.distance_min", "positive", distance_min);
    check_parameter(distance >= distance_min, "planner.distance", ">= distance_min", distance);
    check_parameter(distance_max >= distance, "planner.distance_max", ">= distance", distance_max);
    check_parameter(dwell > 0, "planner.dwell", "positive", dwell);
    check_parameter(lookahead >= 1 && lookahead <= 10, "planner.lookahead", "in [1, 10]", lookahead);
    check_parameter(patience >= 0 && patience <= 1, "planner.patience", "in [0, 1]", patience);
    check_parameter(min_gain >= 0, "planner.min_gain", ">= 0", min_gain);
    expected.check();
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("candidates", p.candidates);
    f("spread", p.spread);
    f("distance", p.distance);
    f("distance_min", p.distance_min);
    f("distance_max", p.distance_max);
    f("dwell", p.dwell);
    f("lookahead", p.lookahead);
    f("patience", p.patience);
    f("min_gain", p.min_gain);
    f("expected", p.expected);
  }
};

}  // namespace agrisee::plan
