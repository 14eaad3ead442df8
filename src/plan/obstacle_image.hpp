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
    using Block = Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1>;
    depth_.fill(std::numeric_limits<float>::infinity());
    const Eigen::Matrix4f& t = optical_T_world.matrix();
    for (Eigen::Index from = 0; from < obstacles.rows(); from += kBlock) {
      const auto block = obstacles.middleRows(from, std::min<Eigen::Index>(kBlock, obstacles.rows() - from));
      const auto along = [&](int axis) -> Block {
        return t(axis, 0) * block.col(0) + t(axis, 1) * block.col(1) + t(axis, 2) * block.col(2) + t(axis, 3);
      };
      const Block z = along(2), u = fx_ * along(0) / z + cx_, v = fy_ * along(1) / z + cy_;
      // Points outside the image go to places of their own behind its pixels: branches, and places that several points
      // in a row would wait for, are slower.
      std::array<float, kBlock> depth;
      std::array<int, kBlock> index;
      const auto count = static_cast<std::size_t>(z.size());
      for (std::size_t i = 0; i < count; ++i) {
        const bool in = inside(u.data()[i], v.data()[i], z.data()[i]);
        depth[i] = z.data()[i];
        index[i] = pixel(in ? u.data()[i] : 0.0f, in ? v.data()[i] : 0.0f) + (in ? 0 : kPixels + static_cast<int>(i));
      }
      for (std::size_t i = 0; i < count; ++i) {
        float& nearest = depth_[static_cast<std::size_t>(index[i])];
        nearest = std::min(nearest, depth[i]);
      }
    }
  }

  /// Whether the point p (m, optical frame) lies in the image and no obstacle is more than 12 mm in front of it in the
  /// four pixels about it: each obstacle counts as two pixels wide, so that a surface of such points has no holes.
  bool shows(const Eigen::Vector3f& p) const {
    const float u = fx_ * p.x() / p.z() + cx_, v = fy_ * p.y() / p.z() + cy_;
    if (!inside(u, v, p.z())) return false;
    const float left = u - 0.5f, right = u + 0.5f, above = v - 0.5f, below = v + 0.5f;
    const float hidden_by = p.z() - 0.012f;
    const auto hides = [&](float x, float y) { return depth_[static_cast<std::size_t>(pixel(x, y))] < hidden_by; };
    if (left >= 0.0f && above >= 0.0f && right < float(kWidth) && below < float(kHeight))  // nearly always
      return !(int(hides(left, above)) | int(hides(right, above)) | int(hides(left, below)) | int(hides(right, below)));
    for (const float y : {above, below})
      for (const float x : {left, right})
        if (inside(x, y, p.z()) && hides(x, y)) return false;
    return true;
  }

 private:
  static constexpr int kWidth = 192, kHeight = 144, kPixels = kWidth * kHeight;
  static constexpr int kBlock = 256;  // points that are projected at once

  /// Whether a point at depth z (m) that is projected to (u, v) is before the camera and in the image.
  static bool inside(float u, float v, float z) {
    return bool(int(z > 0.0f) & int(u >= 0.0f) & int(v >= 0.0f) & int(u < float(kWidth)) & int(v < float(kHeight)));
  }

  /// Index of the pixel at (u, v) inside the image.
  static int pixel(float u, float v) { return static_cast<int>(v) * kWidth + static_cast<int>(u); }

  float fx_, fy_, cx_, cy_;
  std::array<float, kPixels + kBlock> depth_;  // of the nearest obstacle in each pixel (m); the last mean nothing
};

}  // namespace agrisee::plan
