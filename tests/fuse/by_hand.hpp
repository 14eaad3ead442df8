// SPDX-License-Identifier: BSD-3-Clause
// Small views of which it can be worked out by hand what they say. All numbers are short binary fractions, so a point
// can lie exactly on a limit.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/fuse/free_space.hpp>
#include <agrisee/sensor/surface_image.hpp>

namespace agrisee::test {

/// The camera of the small views: it looks along y of world.
inline Pose small_pose() { return look_along({1, 2, 3}, {0, 1, 0}); }

/// A camera whose pixels are 1/4 m apart at z = 1 m. Pixel (3, 2) is on the axis.
inline sensor::Intrinsics small_camera(int width, int height) {
  sensor::Intrinsics k;
  k.width = width;
  k.height = height;
  k.fx = k.fy = 4.0;
  k.cx = 3.0;
  k.cy = 2.0;
  return k;
}

/// A view of a wall: every cell has the same depth (m). No noise, and every pixel returns.
inline sensor::SurfaceImage wall(float depth, int width = 8, int height = 6) {
  sensor::SurfaceImage view;
  view.intrinsics = small_camera(width, height);
  view.world_T_optical = small_pose();
  view.depth.assign(view.intrinsics.size(), depth);
  view.fill = 1.0;
  return view;
}

/// The depth (m) of the cell in column u and row v.
inline float& depth_of(sensor::SurfaceImage& view, int u, int v) {
  return view.depth[static_cast<std::size_t>(v * view.intrinsics.width + u)];
}

/// The point (m, world) at depth z (m) in the middle of the cell in column u and row v.
inline Eigen::Vector3d at(const sensor::SurfaceImage& view, int u, int v, double z) {
  return view.world_T_optical * Eigen::Vector3d(view.intrinsics.ray(u, v) * z);
}

/// Parameters with a margin that is exact in binary.
inline fuse::FreeSpaceParameters quarter() {
  fuse::FreeSpaceParameters parameters;
  parameters.margin = 0.25;
  return parameters;
}

}  // namespace agrisee::test
