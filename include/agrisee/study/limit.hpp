// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What can be seen at all: the fruit's surface that a sensor on the arm can observe from any posture outside keep-out,
/// and how few views would do for somebody who knows the truth. World frame, metres, radians. Cost: about a second for
/// seven fruit and 450 poses on one core, nearly all of it rays.
#pragma once

#include <agrisee/core/grid.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/study/visibility.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::study {

/// How densely sensor poses are tried.
struct LimitParameters {
  int candidates = 4000;        ///< views tried; their directions are spread evenly over the whole sphere
  double distance_min = 0.28;   ///< nearest and
  double distance_max = 0.55;   ///< farthest distance from sensor to target (m); every candidate prefers another
  double cover_radius = 0.005;  ///< a sample counts as covered when one within this distance is seen (m)

  /// The paper gives none; the defaults.
  static LimitParameters paper() { return {}; }
  /// @throws ParameterError naming the field
  void check() const {
    check_parameter(candidates >= 1, "candidates", ">= 1", candidates);
    check_parameter(std::isfinite(distance_min) && distance_min > 0.0, "distance_min", "positive and finite",
                    distance_min);
    check_parameter(std::isfinite(distance_max) && distance_max >= distance_min, "distance_max",
                    "at least distance_min and finite", distance_max);
    check_parameter(std::isfinite(cover_radius) && cover_radius > 0.0, "cover_radius", "positive and finite",
                    cover_radius);
  }
  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("candidates", p.candidates);
    f("distance_min", p.distance_min);
    f("distance_max", p.distance_max);
    f("cover_radius", p.cover_radius);
  }
};

/// A set of samples, a bit each.
using Bits = std::vector<std::uint64_t>;

/// What is seen from where.
struct Observability {
  std::vector<plan::ReachableView>
      views;               ///< that see anything; empty = the arm can look at nothing from where it stands
  std::vector<Bits> seen;  ///< the samples that each of them sees
  Flags observable;        ///< one a sample: seen by any; empty when there are no views

  /// Whether a view sees a sample.
  bool sees(std::size_t view, std::size_t sample) const { return (seen[view][sample / 64] >> (sample % 64)) & 1U; }
};

/// Views of a box that `reach` grants: directions on a Fibonacci sphere, targets in the box and preferred distances by
/// a low-discrepancy sequence (Roberts' R4), so that nothing about the reach is assumed. Nothing is random; the order
/// is fixed.
/// @param reach    called from several threads at once when `threads` > 1
/// @param current  joints that the arm comes from (rad)
/// @param box      what to look at (m)
/// @param params see their struct
/// @param threads the result does not depend on it
/// @throws InputError for an empty box; ParameterError for unusable parameters
inline std::vector<plan::ReachableView> reachable_views(const plan::Reach& reach, const Joints& current,
                                                        const Aabb& box, const LimitParameters& params = {},
                                                        int threads = 1) {
  params.check();
  check_input(!box.empty() && box.min.allFinite() && box.max.allFinite(),
              "reachable views: there is nothing to look at");
  const auto n = static_cast<std::size_t>(params.candidates);
  std::vector<std::optional<plan::ReachableView>> found(n);
  const auto part = [](double x) { return x - std::floor(x); };
  parallel_for(
      n, threads,
      [&](std::size_t i) {
        const auto k = static_cast<double>(i);
        const double z = 1.0 - (2.0 * k + 1.0) / params.candidates, azimuth = kTwoPi * part(k * 0.6180339887498949);
        const double s = std::sqrt(std::max(0.0, 1.0 - z * z));
        // Powers of 1 / 1.1673, the generalised golden ratio of four dimensions.
        const Eigen::Vector3d where(part(k * 0.8566748838545029), part(k * 0.7338918566271260),
                                    part(k * 0.6287067210378087));
        plan::ViewRequest request;
        request.target = box.center() + 0.6 * (where.array() - 0.5).matrix().cwiseProduct(box.size());
        request.direction = {s * std::cos(azimuth), s * std::sin(azimuth), z};
        request.distance_min = params.distance_min;
        request.distance_max = params.distance_max;
        request.distance =
            params.distance_min + part(k * 0.5385972572236101) * (params.distance_max - params.distance_min);
        found[i] = reach(request, current);
      },
      16);
  std::vector<plan::ReachableView> views;
  for (const auto& view : found)
    if (view) views.push_back(*view);
  return views;
}

/// Which samples each of some views sees; views that see nothing are left out.
inline Observability observe_from(const TracedScene& scene, const Samples& samples, const sensor::L515& sensor,
                                  const std::vector<plan::ReachableView>& views, int threads = 1) {
  Observability out;
  std::vector<Bits> seen(views.size());
  parallel_for(
      views.size(), threads,
      [&](std::size_t v) {
        const Flags flags = visible_to(scene, samples, views[v].world_T_optical, sensor);
        seen[v].assign((samples.size() + 63) / 64, 0);
        for (std::size_t i = 0; i < flags.size(); ++i) seen[v][i / 64] |= std::uint64_t{flags[i]} << (i % 64);
      },
      1);
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (std::all_of(seen[v].begin(), seen[v].end(), [](std::uint64_t word) { return word == 0; })) continue;
    out.views.push_back(views[v]);
    out.seen.push_back(std::move(seen[v]));
  }
  if (out.views.empty()) return out;
  out.observable.assign(samples.size(), 0);
  for (std::size_t v = 0; v < out.views.size(); ++v)
    for (std::size_t i = 0; i < samples.size(); ++i) out.observable[i] |= static_cast<std::uint8_t>(out.sees(v, i));
  return out;
}

/// What the arm of a workcell can observe of the samples of a scene's fruit.
/// @return without views, and with empty flags, when there are no samples or nothing is within reach
/// @throws ParameterError for unusable parameters or an unsound mounting
inline Observability observable(const TracedScene& scene, const Samples& samples, const Workcell& cell,
                                const LimitParameters& params = {}, int threads = 1) {
  params.check();
  Aabb box;
  for (const Eigen::Vector3f& p : samples.points) box.extend(p.cast<double>());
  if (box.empty()) return {};
  const plan::Reach reach = plan::reach_of(cell);
  return observe_from(scene, samples, cell.sensor, reachable_views(reach, cell.start, box, params, threads), threads);
}

}  // namespace agrisee::study
