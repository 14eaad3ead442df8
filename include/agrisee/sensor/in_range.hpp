// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Depth images without what lies beyond a range. Metres. Cost: linear in the pixels.
#pragma once

#include <agrisee/sensor/depth_frame.hpp>

#include <utility>

namespace agrisee::sensor {

/// A frame in which points nearer or farther than a range have no return.
/// @param frame rectified; its other channels stay
/// @param least, most distances along the rays (m)
inline DepthFrame in_range(DepthFrame frame, double least, double most) {
  for (int v = 0; v < frame.intrinsics.height; ++v)
    for (int u = 0; u < frame.intrinsics.width; ++u) {
      float& z = frame.depth[frame.intrinsics.index(u, v)];
      const double distance = double(z) * frame.intrinsics.ray(u, v).norm();
      if (!(distance >= least && distance <= most)) z = 0.0f;
    }
  return frame;
}

}  // namespace agrisee::sensor
