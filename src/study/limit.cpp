// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/study/limit.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace agrisee::study {
namespace {

/// The i-th candidate of reachable_views().
plan::ViewRequest candidate(std::size_t i, const Aabb& box, const LimitParameters& parameters) {
  const auto k = static_cast<double>(i);
  const double z = 1.0 - (2.0 * k + 1.0) / parameters.candidates;
  const double turns = k * 0.6180339887498949, azimuth = kTwoPi * (turns - std::floor(turns));
  const double s = std::sqrt(std::max(0.0, 1.0 - z * z));
  plan::ViewRequest request;
  request.target = box.center();
  request.direction = {s * std::cos(azimuth), s * std::sin(azimuth), z};
  request.distance_min = parameters.distance_min;
  request.distance_max = parameters.distance_max;
  plan::spread_aim(request, k, box.size(), 0.6);
  return request;
}

}  // namespace

std::vector<plan::ReachableView> reachable_views(const plan::Reach& reach, const Joints& current, const Aabb& box,
                                                 const LimitParameters& parameters, int threads) {
  parameters.check();
  check_input(!box.empty() && box.min.allFinite() && box.max.allFinite(),
              "reachable views: there is nothing to look at");
  std::vector<std::optional<plan::ReachableView>> found(static_cast<std::size_t>(parameters.candidates));
  parallel_for(
      found.size(), threads, [&](std::size_t i) { found[i] = reach(candidate(i, box, parameters), current); }, 16);
  std::vector<plan::ReachableView> views;
  for (const auto& view : found)
    if (view) views.push_back(*view);
  return views;
}

Observability observe_from(const TracedScene& scene, const Samples& samples, const sensor::DepthCamera& sensor,
                           const std::vector<plan::ReachableView>& views, int threads) {
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

Observability observable(const TracedScene& scene, const Samples& samples, const Workcell& cell,
                         const LimitParameters& parameters, int threads) {
  parameters.check();
  const Aabb box = bounding_box(samples.points);
  if (box.empty()) return {};
  const plan::Reach reach = plan::reach_of(cell);
  return observe_from(scene, samples, cell.sensor, reachable_views(reach, cell.start, box, parameters, threads),
                      threads);
}

}  // namespace agrisee::study
