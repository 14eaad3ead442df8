// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A whole scan in simulation: the pipeline's loop with a ray-cast L515 on the UR3 model.
#pragma once

#include <agrisee/geometry/traced_scene.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/sensor/l515.hpp>

#include <functional>

namespace agrisee::study {

/// How to simulate.
struct SimulationOptions {
  sensor::NoiseModel noise;                           ///< of the simulated sensor
  std::uint64_t seed = 0;                             ///< of noise and planner
  int threads = 1;                                    ///< results do not depend on it
  std::unique_ptr<plan::Planner> planner = nullptr;   ///< another planner than the one the parameters name
  std::function<void(const Pipeline&)> on_view = {};  ///< called after every view that was taken
};

/// Scan a scene until the planner has enough: look, move, capture, observe, and at the end clean, split and locate.
/// The simulated sensor's time counts as `capture`, not as computing.
/// @throws ParameterError; InputError for an unusable workcell
inline ScanResult scan(const Workcell& workcell, const TracedScene& scene, const Parameters& parameters = {},
                       SimulationOptions options = {}) {
  Pipeline pipeline(workcell, parameters, {}, std::move(options.planner), options.seed, options.threads);
  Joints joints = workcell.start;
  while (const auto next = pipeline.next_view(joints)) {
    if (next->joints) joints = *next->joints;
    const auto view = static_cast<std::uint64_t>(pipeline.views().size());
    sensor::Capture capture;
    {
      const Stopwatch watch(pipeline.capture_seconds());
      capture = sensor::capture(scene, workcell.sensor, next->world_T_optical, options.noise, options.seed, view,
                                options.threads);
    }
    pipeline.observe(capture.frame, capture.world_T_optical, next->joints);
    if (options.on_view) options.on_view(pipeline);
  }
  return pipeline.result();
}

}  // namespace agrisee::study
