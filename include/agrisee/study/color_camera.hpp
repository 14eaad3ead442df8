// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A simulated color camera, registered to the depth camera: both share the rays of their pixels.
///
/// A tomato ripens from its blossom end, which hangs lowest, towards its calyx. The lowest share `ripeness` of a
/// fruit's surface is therefore red, with a wavy border and a narrow band of orange below the green. Other objects have
/// the color of their class, or their own (Object::color).
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/study/raycast.hpp>

#include <cstdint>
#include <vector>

namespace agrisee::study {

/// Light and errors of the simulated color camera. The figures are assumed, for a plant in shade and a camera with
/// fixed exposure and white balance.
struct ColorParameters {
  Eigen::Vector3d light = {0.35, -0.6, 0.72};  ///< direction towards the brightest part of the sky or the lamp (world)
  double ambient = 0.55;                       ///< share (0..1) of ambient light, which comes from all sides
  double gloss = 0.5;                          ///< highlight of a fruit: share (0..1) of the lamp's light it reflects
  double gloss_width = 0.14;                   ///< width of a highlight (rad, standard deviation)
  double exposure = 0.06;                      ///< standard deviation of a view's brightness, relative
  double white_balance = 0.02;                 ///< standard deviation of red and blue against green in a view, relative
  double noise = 0.02;                         ///< standard deviation of each channel of a pixel (of its range, 0..1)
};

/// The color (linear light, 0..1 each) of an object's surface at a point, in white light.
/// @param look of the object
/// @param number of the object, which determines its shade of the class's color
/// @param point on its surface (m, world)
Eigen::Vector3d surface_color(const Look& look, std::uint32_t number, const Eigen::Vector3d& point);

/// The color image of a scene. Where rays hit nothing it is dark.
/// @param scene what the camera sees
/// @param rays of its pixels
/// @param intrinsics, world_T_optical of the camera
/// @param parameters light and errors
/// @param seed, view select the random numbers, independently of those of the depth camera
/// @param threads number of threads; the result does not depend on it
/// @return the color of each pixel, row by row
std::vector<Rgb> color_image(const TracedScene& scene, const RayImage& rays, const sensor::Intrinsics& intrinsics,
                             const Pose& world_T_optical, const ColorParameters& parameters, std::uint64_t seed,
                             std::uint64_t view, int threads = 1);

}  // namespace agrisee::study
