// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parameters of the default planner (gain_planner.hpp) and of what it expects to see (expected_surface.hpp). They
/// stand apart so that programs that only read parameters compile fast. Metres, seconds, radians.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/types.hpp>

namespace agrisee::plan {

/// Parameters of ExpectedSurface.
struct ExpectedSurfaceParameters {
  double max_incidence = deg(75);  ///< surface seen at a smaller angle of incidence is expected to be measured (rad)
  int samples = 320;               ///< number of samples of a body's surface
  double cover_radius = 0.005;     ///< a sample is covered if a point is at most this far from it (m)
  double voxel = 0.015;            ///< edge of the voxels of unknown space (m)
  double neighborhood = 0.06;  ///< unknown space counts in full if it is at most this far from a fruit's surface (m)
  double elsewhere = 0.3;      ///< unknown space that is farther from all fruit counts by this factor
  /// Fruit surface expected behind the face of an unknown voxel, as a share of the face. Merged raw points prove no
  /// space empty: with them all voxels stay unknown, and only the view budget ends a scan, unless this is 0.
  double unknown_weight = 0.03;
  double least_confidence = 0.1;  ///< least probability of a fruit for a body that the planner looks at
  double missed_factor = 0.35;  ///< a sample's area is multiplied by this for every view that should have shown it but
                                ///< did not; without effect where raw points are merged

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("max_incidence", p.max_incidence, Range::above(0.0).below({kPi / 2, "pi/2"}).in_radians());
    f("samples", p.samples, Range::between(1, 100000));
    f("cover_radius", p.cover_radius, Range::positive());
    f("voxel", p.voxel, Range::positive());
    f("neighborhood", p.neighborhood, Range::not_negative());
    f("elsewhere", p.elsewhere, Range::between(0.0, 1.0));
    f("unknown_weight", p.unknown_weight, Range::not_negative());
    f("least_confidence", p.least_confidence, Range::between(0.0, 1.0));
    f("missed_factor", p.missed_factor, Range::between(0.0, 1.0));
  }
};

/// Parameters of GainPlanner.
struct GainPlannerParameters {
  int candidates = 2000;  ///< number of views that are compared, in directions all over the sphere; a tenth to a
                          ///< quarter of them can be reached
  double spread = 0.6;    ///< how far from the middle of the bodies the views aim, as a share of the way to the border
  double distance = kViewDistance;  ///< distance of the first view from its target (m); with `fixed` and `random`
                                    ///< of all views
  double distance_min = 0.27;       ///< shortest distance of a view from its target (m)
  double distance_max = 0.55;       ///< longest distance of a view from its target (m)
  double dwell = 20.0;  ///< what a view costs besides the move (s): the default asks for few views; with a slow arm the
                        ///< true 1 to 3 s for settling, exposure and computing ask for shorter moves and more views
  double min_gain = 0.0012;  ///< the scan ends when the best view promises less than this share of the fruit surface
                             ///< known, which counts as at least that of one fruit of middle size
  ExpectedSurfaceParameters expected;  ///< what a view is expected to show

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range where there is none.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("candidates", p.candidates, Range::between(1, 1000000));
    f("spread", p.spread, Range::between(0.0, 1.0));
    f("distance", p.distance,
      Range::between({p.distance_min, "distance_min"}, {p.distance_max, "distance_max"}).in_metres());
    f("distance_min", p.distance_min, Range::positive());
    f("distance_max", p.distance_max, Range::at_least({p.distance, "distance"}));
    f("dwell", p.dwell, Range::positive());
    f("min_gain", p.min_gain, Range::not_negative());
    f("expected", p.expected);
  }
};

}  // namespace agrisee::plan
