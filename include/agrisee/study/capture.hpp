// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A simulated depth camera: it casts rays into a scene (raycast.hpp) and applies a noise model (depth_noise.hpp). A
/// color camera (color_camera.hpp) and a detector (detector.hpp) may look along the same rays.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/sensor/depth_camera.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/study/color_camera.hpp>
#include <agrisee/study/depth_noise.hpp>
#include <agrisee/study/detector.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <cstdint>
#include <optional>

namespace agrisee::study {

/// The result of one simulated view.
struct Capture {
  sensor::DepthFrame frame;  ///< measured depth z of each pixel (m); 0 = no return
  Pose world_T_optical;      ///< the sensor pose that the robot reports; only the noise model `rough` falsifies it
};

/// Takes a depth frame of a scene. A surface nearer than `sensor.range_min` gives no return, but it occludes what lies
/// behind it. A measured range outside the sensor's limits gives no return either.
/// @param scene what the sensor sees
/// @param sensor intrinsics and limits of the camera
/// @param world_T_optical true pose of the sensor
/// @param noise the noise model
/// @param seed, view select the random numbers: the same pair gives the same frame, different pairs give independent
/// noise
/// @param threads number of threads; the result does not depend on it
/// @throws ParameterError for unusable limits or noise, InputError for unusable intrinsics or a pose that is not rigid
Capture capture(const TracedScene& scene, const sensor::DepthCamera& sensor, const Pose& world_T_optical,
                const NoiseModel& noise, std::uint64_t seed, std::uint64_t view, int threads = 1);

/// The simulated color camera and detector of a view.
struct ImageOptions {
  bool color = false;                               ///< add colors
  std::optional<DetectorParameters> detector = {};  ///< add the masks of this detector
  ColorParameters light = {};                       ///< light and errors of the colors

  /// Whether anything is added.
  bool any() const { return color || detector; }
};

/// Add colors and detections to a frame. Its depths stay as they are. The additions depend only on the scene, the
/// pose, the seed and the number of the view.
/// @param frame its intrinsics are read
/// @param scene what the camera sees
/// @param sensor its largest range is how far the camera sees
/// @param world_T_optical true pose of the camera
/// @param options what is added
/// @param seed, view select the random numbers
/// @param threads number of threads; the result does not depend on it
/// @throws ParameterError, InputError as capture
void add_images(sensor::DepthFrame& frame, const TracedScene& scene, const sensor::DepthCamera& sensor,
                const Pose& world_T_optical, const ImageOptions& options, std::uint64_t seed, std::uint64_t view,
                int threads = 1);

}  // namespace agrisee::study
