// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/study/limit.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace agrisee::study {
namespace {

/// The i-th candidate of reachable_views().
plan::ViewRequest candidate(std::size_t i, const Aabb& box, const LimitParameters& parameters) {
  const auto fraction = [](double x) { return x - std::floor(x); };
  const auto k = static_cast<double>(i);
  const double z = 1.0 - (2.0 * k + 1.0) / parameters.candidates;
  const double azimuth = kTwoPi * fraction(k * 0.6180339887498949);
  const double s = std::sqrt(std::max(0.0, 1.0 - z * z));
  // R4: powers of 1 / 1.1673, the inverse of the generalised golden ratio in four dimensions.
  const Eigen::Vector3d where(fraction(k * 0.8566748838545029), fraction(k * 0.7338918566271260),
                              fraction(k * 0.6287067210378087));
  plan::ViewRequest request;
  request.target = box.center() + 0.6 * (where.array() - 0.5).matrix().cwiseProduct(box.size());
  request.direction = {s * std::cos(azimuth), s * std::sin(azimuth), z};
  request.distance_min = parameters.distance_min;
  request.distance_max = parameters.distance_max;
  request.distance =
      parameters.distance_min + fraction(k * 0.5385972572236101) * (parameters.distance_max - parameters.distance_min);
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
