// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Axis-aligned boxes.
#pragma once

#include <agrisee/core/traits.hpp>

#include <limits>

namespace agrisee {

/// An axis-aligned box [min, max] (m). A default-constructed one is empty.
struct Aabb {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());   ///< m
  Eigen::Vector3d max = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());  ///< m

  /// True if the box contains no point.
  bool empty() const { return (min.array() > max.array()).any(); }
  /// Center (m).
  Eigen::Vector3d center() const { return 0.5 * (min + max); }
  /// Edge lengths (m).
  Eigen::Vector3d size() const { return max - min; }
  /// True for points inside the box or on its border; false for points that are not finite.
  template <typename V>
  bool contains(const V& p) const {
    for (int a = 0; a < 3; ++a)
      if (!(double(p[a]) >= min[a] && double(p[a]) <= max[a])) return false;
    return true;
  }
  /// Enlarges the box so that it contains p (m).
  void extend(const Eigen::Vector3d& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  /// Distance (m) from p to the box; 0 inside.
  double distance(const Eigen::Vector3d& p) const { return (min - p).cwiseMax(p - max).cwiseMax(0.0).norm(); }
};

/// The box about points (m) of any type of vector; those that are not finite are left out.
template <typename Points>
Aabb bounding_box(const Points& points) {
  Aabb box;
  for (const auto& p : points)
    if (p.allFinite()) box.extend(p.template cast<double>());
  return box;
}

}  // namespace agrisee
