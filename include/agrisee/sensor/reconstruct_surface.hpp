// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a noisy depth image to the surface behind it: cells of a few pixels, each with depth, normal and uncertainty.
///
/// A depth sensor measures far more densely (0.5 mm at arm's length) than a fruit's surface needs, and its error lies
/// along the ray. The steps:
/// 1. Crop: only pixels inside the scan volume count, and those outside whose distance from it is within the noise.
/// 2. Blocks: the image is divided into blocks of b x b pixels, of about the wanted spacing. Each block keeps the mean
///    of those of its pixels that agree with its median.
/// 3. Fit: a paraboloid is fitted around each block, over a window that grows with the noise of the blocks. It stands
///    on a plane nearly tangent to the surface: depth as a function of the pixel would be no paraboloid on the steep
///    side of a small fruit. Residuals are measured along the rays. Weights exclude surface beyond a depth edge
///    (iteratively reweighted least squares with Tukey's biweight). The fit's height, slope and variance at the block
///    give point, normal and uncertainty.
/// 4. Sample: each fit gives one surface point, or several along the slope where the surface is steep. Points outside
///    of the volume are dropped.
///
/// Cost: linear in the pixels, and in the blocks times the cells of the window. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/sensor/surface_image.hpp>

namespace agrisee::sensor {

/// The surface of a depth image inside `volume`.
///
/// Invalid pixels, cells without support and surface outside the volume give no points. `depth` of the result
/// also covers surface outside the volume, as evidence of free space.
/// @param frame the measured image
/// @param world_T_optical pose of the sensor when the frame was taken
/// @param volume the scan volume (m, world)
/// @param parameters see their struct
/// @param threads the result does not depend on it
/// @throws InputError for a frame whose size disagrees with its intrinsics or a pose that is not rigid; ParameterError
SurfaceImage reconstruct_surface(const DepthFrame& frame, const Pose& world_T_optical, const Aabb& volume,
                                 const SurfaceParameters& parameters = {}, int threads = 1);

}  // namespace agrisee::sensor
