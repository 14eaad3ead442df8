// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/stopwatch.hpp>
#include <agrisee/study/simulated_scan.hpp>

#include <utility>

namespace agrisee::study {

ViewTaker simulated_views(const TracedScene& scene, const sensor::DepthCamera& sensor, const NoiseModel& noise,
                          std::uint64_t seed, int threads) {
  return [&scene, sensor, noise, seed, threads](const plan::ReachableView& view, std::size_t number) {
    return std::optional(capture(scene, sensor, view.world_T_optical, noise, seed, number, threads));
  };
}

ViewTaker with_images(ViewTaker take_view, const TracedScene& scene, const sensor::DepthCamera& sensor,
                      const ImageOptions& options, std::uint64_t seed, int threads) {
  if (!options.any()) return take_view;
  return [take_view = std::move(take_view), &scene, sensor, options, seed, threads](const plan::ReachableView& view,
                                                                                    std::size_t number) {
    auto taken = take_view(view, number);
    if (taken) add_images(taken->frame, scene, sensor, view.world_T_optical, options, seed, number, threads);
    return taken;
  };
}

ScanResult scan(const Workcell& workcell, const TracedScene& scene, const Parameters& parameters,
                SimulationOptions options) {
  PipelineOptions pipeline_options;
  pipeline_options.planner = std::move(options.planner);
  pipeline_options.reach = std::move(options.reach);
  pipeline_options.seed = options.seed;
  pipeline_options.threads = options.threads;
  Pipeline pipeline(workcell, parameters, std::move(pipeline_options));
  ViewTaker take_view = simulated_views(scene, workcell.sensor, options.noise, options.seed, options.threads);
  if (options.around) take_view = options.around(std::move(take_view));
  take_view = with_images(std::move(take_view), scene, workcell.sensor, options.images, options.seed, options.threads);

  Joints joints = workcell.start;
  double capture_seconds = 0.0;
  while (const auto next = pipeline.next_view(joints)) {
    auto taken = timed(capture_seconds, [&] { return take_view(*next, pipeline.views().size()); });
    if (!taken) {
      pipeline.refused();
      continue;
    }
    if (next->joints) joints = *next->joints;
    pipeline.observe(std::move(taken->frame), taken->world_T_optical, next->joints);
    if (options.on_view) options.on_view(pipeline);
  }
  ScanResult result = pipeline.result();
  result.seconds.capture = capture_seconds;
  return result;
}

}  // namespace agrisee::study
