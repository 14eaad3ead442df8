// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A whole scan in simulation: the pipeline's loop with a ray-cast L515 on the UR3 model.
#pragma once

#include <agrisee/geometry/traced_scene.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/sensor/l515.hpp>

#include <functional>

namespace agrisee::study {

/// Takes a view: moves the arm there and looks. Nothing when the view could not be taken; the planner is then asked for
/// another.
/// @param number of the view in the scan, from 0: how many were taken before
using Look = std::function<std::optional<sensor::Capture>(const plan::ReachableView& view, std::size_t number)>;

/// An arm that always arrives, and a ray-cast L515. A frame depends on pose, noise, seed and number alone.
inline Look simulated_look(const TracedScene& scene, const sensor::L515& sensor, const sensor::NoiseModel& noise,
                           std::uint64_t seed, int threads = 1) {
  return [&scene, sensor, noise, seed, threads](const plan::ReachableView& view, std::size_t number) {
    return std::optional(sensor::capture(scene, sensor, view.world_T_optical, noise, seed, number, threads));
  };
}

/// How to simulate.
struct SimulationOptions {
  sensor::NoiseModel noise;                           ///< of the simulated sensor
  std::uint64_t seed = 0;                             ///< of noise and planner
  int threads = 1;                                    ///< results do not depend on it
  std::unique_ptr<plan::Planner> planner = nullptr;   ///< another planner than the one the parameters name
  std::function<Look(Look)> around = {};              ///< puts something around sensor and arm: a recorder, faults...
  std::function<void(const Pipeline&)> on_view = {};  ///< called after every view that was taken
};

/// Scan a scene until the planner has enough: look, move, capture, observe, and at the end clean, split and locate.
/// The simulated sensor's time counts as `capture`, not as computing.
/// @throws ParameterError; InputError for an unusable workcell
inline ScanResult scan(const Workcell& workcell, const TracedScene& scene, const Parameters& parameters = {},
                       SimulationOptions options = {}) {
  Pipeline pipeline(workcell, parameters, {}, std::move(options.planner), options.seed, options.threads);
  Look look = simulated_look(scene, workcell.sensor, options.noise, options.seed, options.threads);
  if (options.around) look = options.around(std::move(look));
  Joints joints = workcell.start;
  while (const auto next = pipeline.next_view(joints)) {
    std::optional<sensor::Capture> capture;
    {
      const Stopwatch watch(pipeline.capture_seconds());
      capture = look(*next, pipeline.views().size());
    }
    if (!capture) {
      pipeline.refused();
      continue;
    }
    if (next->joints) joints = *next->joints;
    pipeline.observe(capture->frame, capture->world_T_optical, next->joints);
    if (options.on_view) options.on_view(pipeline);
  }
  return pipeline.result();
}

}  // namespace agrisee::study
