// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The observable part of the fruit's surface: what the sensor can see from any posture of the arm outside keep-out
/// spaces. World frame, metres, radians. Cost: about a second for seven fruit and 450 poses on one core, nearly all of
/// it ray casting.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/plan/planner.hpp>
#include <agrisee/study/visibility.hpp>
#include <agrisee/workcell.hpp>

#include <cstdint>
#include <vector>

namespace agrisee::study {

/// Which sensor poses are tried.
struct LimitParameters {
  int candidates = 4000;        ///< number of views tried; their directions are spread evenly over the whole sphere
  double distance_min = 0.28;   ///< shortest distance from sensor to target (m)
  double distance_max = 0.55;   ///< longest; every candidate prefers another distance between the two (m)
  double cover_radius = 0.005;  ///< a sample counts as covered if a sample within this distance is seen (m)

  /// [1] gives no values; these are the defaults.
  static LimitParameters paper() { return {}; }

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("candidates", p.candidates, Range::at_least(1));
    f("distance_min", p.distance_min, Range::positive());
    f("distance_max", p.distance_max, Range::at_least({p.distance_min, "distance_min"}));
    f("cover_radius", p.cover_radius, Range::positive());
  }
};

/// A set of samples, one bit per sample.
using Bits = std::vector<std::uint64_t>;

/// Which views see which samples.
struct Observability {
  std::vector<plan::ReachableView> views;  ///< views that see any sample; empty: the arm can see nothing from its place
  std::vector<Bits> seen;                  ///< the samples that each of the views sees
  Flags observable;                        ///< per sample: seen by any view; empty if there are no views

  /// Whether a view sees a sample.
  bool sees(std::size_t view, std::size_t sample) const { return (seen[view][sample / 64] >> (sample % 64)) & 1U; }
};

/// Views of a box that `reach` grants.
///
/// Directions lie on a Fibonacci sphere; targets in the box and preferred distances follow a low-discrepancy sequence
/// (Roberts' R4), so that nothing is assumed about the reach. Nothing is random, and the order is fixed.
/// @param reach called from several threads at once if `threads` > 1
/// @param current joints before the move (rad)
/// @param box what to look at (m, world)
/// @param parameters which poses are tried
/// @param threads number of threads; the result does not depend on it
/// @throws InputError for an empty box; ParameterError
std::vector<plan::ReachableView> reachable_views(const plan::Reach& reach, const Joints& current, const Aabb& box,
                                                 const LimitParameters& parameters = {}, int threads = 1);

/// Which samples each of some views sees. Views that see nothing are left out.
/// @param scene what hides samples
/// @param samples of the fruit's surface
/// @param sensor the camera
/// @param views where it looks from
/// @param threads number of threads; the result does not depend on it
Observability observe_from(const TracedScene& scene, const Samples& samples, const sensor::DepthCamera& sensor,
                           const std::vector<plan::ReachableView>& views, int threads = 1);

/// What the arm of a workcell can observe of the samples.
/// @param scene what hides samples
/// @param samples of the fruit's surface
/// @param cell arm, camera and keep-out spaces
/// @param parameters which poses are tried
/// @param threads number of threads; the result does not depend on it
/// @return without views, and with empty flags, if there are no samples or nothing is within reach
/// @throws ParameterError, also if the arm's mount is not valid
Observability observable(const TracedScene& scene, const Samples& samples, const Workcell& cell,
                         const LimitParameters& parameters = {}, int threads = 1);

}  // namespace agrisee::study
