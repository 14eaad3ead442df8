// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A complete scan in simulation: a Pipeline drives the arm model, and a simulated depth camera takes the views.
#pragma once

#include <agrisee/pipeline.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace agrisee::study {

/// Moves the arm to a view and captures a frame there. Returns nothing if the view could not be taken; the planner is
/// then asked for another one.
/// @param view where to go
/// @param number how many views of this scan were taken before
using ViewTaker = std::function<std::optional<Capture>(const plan::ReachableView& view, std::size_t number)>;

/// A ViewTaker whose arm always arrives and whose camera casts rays into the scene. A frame depends only on the pose,
/// the noise, the seed and the number of the view.
/// @param scene what the camera sees; it must outlive the returned function
/// @param sensor intrinsics and limits of the camera
/// @param noise the noise model
/// @param seed of the noise
/// @param threads number of threads; the frames do not depend on it
ViewTaker simulated_views(const TracedScene& scene, const sensor::DepthCamera& sensor, const NoiseModel& noise,
                          std::uint64_t seed, int threads = 1);

/// Wrap a ViewTaker so that each frame gets colors and detections (add_images). These depend only on the requested
/// pose and the number of the view, so that a frame that was recorded without images gets the same ones again.
/// @param take_view takes the views
/// @param scene what the cameras see; it must outlive the returned function
/// @param sensor limits of the camera
/// @param options what is added
/// @param seed of the random numbers
/// @param threads number of threads; the images do not depend on it
ViewTaker with_images(ViewTaker take_view, const TracedScene& scene, const sensor::DepthCamera& sensor,
                      const ImageOptions& options, std::uint64_t seed, int threads = 1);

/// Options of scan().
struct SimulationOptions {
  NoiseModel noise;                                   ///< noise of the simulated sensor
  ImageOptions images = {};                           ///< colors and detections to simulate
  std::uint64_t seed = 0;                             ///< seed of the noise and of the planner
  int threads = 1;                                    ///< number of threads; the result does not depend on it
  std::unique_ptr<plan::Planner> planner = nullptr;   ///< replaces the planner that the parameters name
  plan::Reach reach = {};                             ///< replaces the reach of the workcell's arm
  std::function<ViewTaker(ViewTaker)> around = {};    ///< wraps the simulated views, for example to record them or to
                                                      ///< simulate faults
  std::function<void(const Pipeline&)> on_view = {};  ///< called after each view that was taken
};

/// Scans a scene: asks the pipeline for the next view, takes it and passes the frame on, until no view is left. Then
/// the pipeline cleans and segments the cloud, locates the fruit and plans the picking. The time spent in simulation is
/// reported as Timing::capture, apart from the computing time.
/// @param workcell arm, sensor, scan volume and keep-out
/// @param scene what the sensor sees
/// @param parameters of the pipeline
/// @param options of the simulation
/// @throws ParameterError for unusable parameters or noise, InputError for an unusable workcell, Cancelled
ScanResult scan(const Workcell& workcell, const TracedScene& scene, const Parameters& parameters = {},
                SimulationOptions options = {});

}  // namespace agrisee::study
