// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A simulated colour camera, registered to the depth camera: pixel by pixel the same rays.
///
/// A tomato turns from its blossom end, which hangs lowest, towards its calyx. So of a fruit whose surface has turned
/// to the share `ripeness`, that lowest share of its surface is red, with a wavy border and a narrow band of orange
/// between it and the green above. Other objects have the color of their class, or their own (Object::color).
#pragma once

#include <agrisee/core/color.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/study/raycast.hpp>

#include <cstdint>
#include <vector>

namespace agrisee::study {

/// Light and errors of the simulated colour camera. The figures are assumed; they are those of a plant in shade and of
/// a camera whose exposure and white balance are fixed.
struct ColorParameters {
  Eigen::Vector3d light = {0.35, -0.6, 0.72};  ///< direction towards the brightest part of the sky or the lamp (world)
  double ambient = 0.55;                       ///< share (0..1) of the light that comes from all sides
  double gloss = 0.5;                          ///< highlight of a fruit: how much of the lamp it mirrors, 0..1
  double gloss_width = 0.14;                   ///< how far a highlight reaches (rad, standard deviation)
  double exposure = 0.06;                      ///< standard deviation of a view's brightness, relative
  double white_balance = 0.02;                 ///< standard deviation of red and blue against green in a view, relative
  double noise = 0.02;                         ///< standard deviation of each channel of a pixel (of its range, 0..1)
};

/// The color (linear light, 0..1 each) of an object's surface at a point, in white light.
/// @param look of the object
/// @param number of the object, which chooses its shade of the class's color
/// @param point on its surface (m, world)
Eigen::Vector3d surface_color(const Look& look, std::uint32_t number, const Eigen::Vector3d& point);

/// The color image of a scene. Where rays hit nothing it is dark.
/// @param scene what the camera sees
/// @param rays those of its pixels
/// @param intrinsics, world_T_optical of the camera
/// @param parameters light and errors
/// @param seed, view select the random numbers, independently of those of the depth camera
/// @param threads number of threads; the result does not depend on it
/// @return the color of each pixel, row by row
std::vector<Rgb> color_image(const TracedScene& scene, const RayImage& rays, const sensor::Intrinsics& intrinsics,
                             const Pose& world_T_optical, const ColorParameters& parameters, std::uint64_t seed,
                             std::uint64_t view, int threads = 1);

}  // namespace agrisee::study
