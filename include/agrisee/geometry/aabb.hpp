// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Axis-aligned boxes.
#pragma once

#include <agrisee/core/traits.hpp>

#include <limits>

namespace agrisee {

/// An axis-aligned box [min, max] (m); empty when default-made.
struct Aabb {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());   ///< m
  Eigen::Vector3d max = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());  ///< m

  /// Whether it holds no point.
  bool empty() const { return (min.array() > max.array()).any(); }
  /// Its middle (m).
  Eigen::Vector3d center() const { return 0.5 * (min + max); }
  /// Its edges (m).
  Eigen::Vector3d size() const { return max - min; }
  /// True for points inside or on the border; false for points that are not finite.
  template <typename V>
  bool contains(const V& p) const {
    for (int a = 0; a < 3; ++a)
      if (!(double(p[a]) >= min[a] && double(p[a]) <= max[a])) return false;
    return true;
  }
  /// Make it hold p (m), too.
  void extend(const Eigen::Vector3d& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  /// Distance (m) from p to the box, 0 inside.
  double distance(const Eigen::Vector3d& p) const { return (min - p).cwiseMax(p - max).cwiseMax(0.0).norm(); }
};

/// The cluster frame's origin {R} in world: the corner of the scan volume that is lowest, leftmost and farthest as seen
/// from `eye` (the robot's base) looking at the volume's centre; its axes are parallel to world's (paper, Localization;
/// scene-format contract). Far is along the world axis (x or y) that the line of sight is nearest to.
inline Eigen::Vector3d cluster_origin(const Aabb& volume, const Eigen::Vector3d& eye) {
  const Eigen::Vector3d sight = volume.center() - eye;
  Eigen::Vector3d corner = volume.min;  // lowest
  const int far_axis = std::abs(sight.x()) > std::abs(sight.y()) ? 0 : 1;
  const double forward = sight[far_axis] < 0.0 ? -1.0 : 1.0;
  corner[far_axis] = forward > 0.0 ? volume.max[far_axis] : volume.min[far_axis];
  // left = up x forward: looking along +y left is -x; looking along +x left is +y
  const int side_axis = 1 - far_axis;
  const double left = far_axis == 1 ? -forward : forward;
  corner[side_axis] = left > 0.0 ? volume.max[side_axis] : volume.min[side_axis];
  return corner;
}

}  // namespace agrisee
