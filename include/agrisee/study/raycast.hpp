// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Renders a range image of a scene: one ray per pixel of a pinhole camera.
///
/// The image is equal, bit for bit, to one Bvh::closest() per pixel, but it is computed many times faster. The image is
/// divided into tiles. The tree is traversed once per tile with the tile's view pyramid, and each triangle found is
/// tested only against the pixels that its projection covers. A tile with too many triangles is traced ray by ray.
/// The cost is about O(tiles log n + triangles in view + pixels hit).
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/sensor/intrinsics.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <cstdint>
#include <limits>
#include <vector>

namespace agrisee::study {

/// The value in RayImage::triangle for a ray that hits nothing.
constexpr std::uint32_t kNoHit = std::numeric_limits<std::uint32_t>::max();

/// The first hit of each pixel's ray. Both images hold intrinsics.size() values, row by row.
struct RayImage {
  std::vector<float> range;             ///< distance along the ray (m); 0 if the ray hits nothing
  std::vector<std::uint32_t> triangle;  ///< index of the triangle in the traced scene, or kNoHit
};

/// The unit direction, in world, of the ray that raycast() casts through pixel (u, v).
Eigen::Vector3f ray_direction(const sensor::Intrinsics& intrinsics, const Pose& world_T_optical, double u, double v);

/// Casts one ray per pixel.
///
/// Pixel (u, v) receives the hit of `scene.bvh().closest(eye, ray_direction(...), 0, range_max)`, where the eye is the
/// origin of the optical frame in single precision. A hit nearer than `range_min` gives kNoHit: such a surface is not
/// measured, but it still occludes what lies behind it.
/// @param scene what the rays can hit
/// @param intrinsics of the camera
/// @param world_T_optical pose of the optical frame (z forward, x right, y down)
/// @param range_min, range_max limits along the ray (m), 0 <= range_min <= range_max
/// @param threads number of threads; the result does not depend on it
/// @throws InputError for unusable intrinsics or a pose that is not rigid, ParameterError for unusable limits
RayImage raycast(const TracedScene& scene, const sensor::Intrinsics& intrinsics, const Pose& world_T_optical,
                 double range_min, double range_max, int threads = 1);

}  // namespace agrisee::study
