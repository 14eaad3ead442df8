// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A coarse depth image of obstacles, to tell which points a view would show. Metres.
#pragma once

#include <agrisee/sensor/intrinsics.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace agrisee::plan {

using Coordinates = Eigen::Map<const Eigen::Array<float, Eigen::Dynamic, 3>>;  // of points (m, world), one a row

/// A coarse depth image of obstacles, seen from one view.
class ObstacleImage {
 public:
  /// Of points (m, world). They are projected in blocks, so that the compiler can use vector instructions: hundreds of
  /// views are compared after each frame.
  ObstacleImage(const sensor::Intrinsics& k, const Eigen::Isometry3f& optical_T_world, const Coordinates& obstacles)
      : fx_(static_cast<float>(k.fx / k.width * kWidth)),
        fy_(static_cast<float>(k.fy / k.height * kHeight)),
        cx_(static_cast<float>((k.cx + 0.5) / k.width * kWidth)),
        cy_(static_cast<float>((k.cy + 0.5) / k.height * kHeight)) {
    constexpr Eigen::Index kBlock = 256;
    using Block = Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1>;
    depth_.fill(std::numeric_limits<float>::infinity());
    const Eigen::Matrix4f& t = optical_T_world.matrix();
    for (Eigen::Index from = 0; from < obstacles.rows(); from += kBlock) {
      const auto block = obstacles.middleRows(from, std::min(kBlock, obstacles.rows() - from));
      const auto along = [&](int axis) -> Block {
        return t(axis, 0) * block.col(0) + t(axis, 1) * block.col(1) + t(axis, 2) * block.col(2) + t(axis, 3);
      };
      const Block z = along(2), u = fx_ * along(0) / z + cx_, v = fy_ * along(1) / z + cy_;
      for (Eigen::Index i = 0; i < z.size(); ++i) {
        const int c = pixel(u[i], v[i], z[i]);
        if (c >= 0) depth_[static_cast<std::size_t>(c)] = std::min(depth_[static_cast<std::size_t>(c)], z[i]);
      }
    }
  }

  /// Whether the point p (m, optical frame) lies in the image and no obstacle is more than 12 mm in front of it in the
  /// four pixels about it: each obstacle counts as two pixels wide, so that a surface of such points has no holes.
  bool shows(const Eigen::Vector3f& p) const {
    const float u = fx_ * p.x() / p.z() + cx_, v = fy_ * p.y() / p.z() + cy_;
    if (pixel(u, v, p.z()) < 0) return false;
    const float hidden_by = p.z() - 0.012f;
    for (const float dv : {-0.5f, 0.5f})
      for (const float du : {-0.5f, 0.5f})
        if (const int c = pixel(u + du, v + dv, p.z()); c >= 0 && depth_[static_cast<std::size_t>(c)] < hidden_by)
          return false;
    return true;
  }

 private:
  static constexpr int kWidth = 192, kHeight = 144;

  /// Index of the pixel at (u, v) of a point at depth z (m), -1 outside the image and behind the camera.
  static int pixel(float u, float v, float z) {
    if (!(z > 0.0f && u >= 0.0f && v >= 0.0f && u < float(kWidth) && v < float(kHeight))) return -1;
    return static_cast<int>(v) * kWidth + static_cast<int>(u);
  }

  float fx_, fy_, cx_, cy_;
  std::array<float, kWidth * kHeight> depth_;  // of the nearest obstacle in each pixel (m)
};

}  // namespace agrisee::plan
