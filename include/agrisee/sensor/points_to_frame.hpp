// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Turns the unorganized points of one view into a depth image, so that sensors that give no image can be used too.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/sensor/depth_frame.hpp>

namespace agrisee::sensor {

/// Each point becomes the depth of the pixel that sees it; if several do, the nearest wins. Points that are behind the
/// sensor, outside the image or not finite are left out.
/// @param points (m, optical frame: z forward, x right, y down), any cloud type
/// @param intrinsics of the image
/// @throws ParameterError for intrinsics without pixels
template <typename C>
DepthFrame frame_from_points(const C& points, const Intrinsics& intrinsics) {
  check_parameter(intrinsics.width >= 1, "sensor width", "1 or more", intrinsics.width);
  check_parameter(intrinsics.height >= 1, "sensor height", "1 or more", intrinsics.height);
  DepthFrame frame;
  frame.intrinsics = intrinsics;
  frame.depth.assign(intrinsics.size(), 0.0f);
  for (std::size_t i = 0; i < agrisee::size(points); ++i) {
    const Eigen::Vector3d p = point(points, i).template cast<double>();
    if (!is_finite(p)) continue;
    const auto pixel = intrinsics.pixel_of(p);
    if (!pixel) continue;
    float& z = frame.depth[*pixel];
    if (z == 0.0f || static_cast<float>(p.z()) < z) z = static_cast<float>(p.z());
  }
  return frame;
}

}  // namespace agrisee::sensor
