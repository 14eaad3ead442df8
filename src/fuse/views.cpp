// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/views.hpp>

namespace agrisee::fuse {

std::size_t count_inside(const sensor::DepthFrame& frame, const Pose& world_T_optical, const Aabb& volume) {
  std::size_t count = 0;
  for (int v = 0; v < frame.intrinsics.height; ++v)
    for (int u = 0; u < frame.intrinsics.width; ++u) {
      const Eigen::Vector3d p = frame.intrinsics.ray(u, v) * double(frame.at(u, v));
      count += sensor::DepthFrame::valid(frame.at(u, v)) && volume.contains(world_T_optical * p);
    }
  return count;
}

}  // namespace agrisee::fuse
