// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which samples of the fruit's surface are visible from a position: those that face it and that nothing occludes.
/// World frame, metres. The cost is one short ray for each sample that faces the position.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/sensor/depth_camera.hpp>
#include <agrisee/study/samples.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace agrisee::study {

/// One flag per sample: 1 = yes, 0 = no.
using Flags = std::vector<std::uint8_t>;

/// Flags the samples that are visible from a point in any direction.
/// @param scene what can occlude the samples
/// @param samples of the fruit's surface
/// @param eye the point (m, world)
/// @param max_incidence largest angle between the line of sight and the normal (rad)
/// @param threads number of threads; the result does not depend on it
Flags visible_from(const TracedScene& scene, const Samples& samples, const Eigen::Vector3d& eye,
                   double max_incidence = 0.5 * kPi, int threads = 1);

/// Flags the samples that a sensor at `world_T_optical` can measure: inside the image, within range, below the largest
/// incidence, and not occluded. Noise and the raster of the pixels are ignored.
Flags visible_to(const TracedScene& scene, const Samples& samples, const Pose& world_T_optical,
                 const sensor::DepthCamera& sensor, int threads = 1);

/// Share of the samples of the fruit `id` that are flagged; 0 for a fruit without samples. There must be one flag per
/// sample.
double share(const Samples& samples, const Flags& flags, int id);

/// Share of all samples that are flagged; 0 if there are no samples or no flags.
/// @throws InputError if there are flags, but not one per sample
double share(const Samples& samples, const Flags& flags);

/// How much of one fruit can be observed.
struct FruitShare {
  int id = 0;               ///< Object::id of the fruit
  std::size_t samples = 0;  ///< number of samples of its surface
  double observable = 0.0;  ///< share of these samples that can be observed
};

/// How much can be observed of each fruit that has samples, in ascending order of ids.
/// @param samples of the fruit's surface
/// @param observable one flag per sample, or no flags at all: then the shares are 0
/// @throws InputError if there are flags, but not one per sample
std::vector<FruitShare> fruit_shares(const Samples& samples, const Flags& observable);

/// Mean position (m, world) of the flagged samples of the fruit `id`; empty if there are none. There must be one flag
/// per sample.
std::optional<Eigen::Vector3d> mean_of(const Samples& samples, const Flags& flags, int id);

}  // namespace agrisee::study
