// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// `pcl::PointCloud<T>` as a cloud, in place: every point type T with members x, y and z, PCL's own or another's.
/// Normals (`normal_x`, `normal_y`, `normal_z`) are known where T has them. Needs PCL's headers; links nothing.
#pragma once

#include <agrisee/core/traits.hpp>

#include <pcl/point_cloud.h>
#include <type_traits>

namespace agrisee {

/// PCL's clouds of any point type with x, y and z.
template <typename T>
struct CloudTraits<pcl::PointCloud<T>, std::void_t<decltype(std::declval<T&>().x), decltype(std::declval<T&>().y),
                                                   decltype(std::declval<T&>().z)>> {
  /// Of coordinates.
  using Scalar = decltype(std::declval<T&>().x);
  /// Number of points.
  static std::size_t size(const pcl::PointCloud<T>& c) { return c.size(); }
  /// Point i (m).
  static Vector3<Scalar> point(const pcl::PointCloud<T>& c, std::size_t i) {
    const T& p = c.points[i];
    return {p.x, p.y, p.z};
  }

  /// Normal i, where the point type has one.
  template <typename U = T>
  static auto normal(const pcl::PointCloud<U>& c, std::size_t i) -> Vector3<decltype(std::declval<U&>().normal_x)> {
    const U& p = c.points[i];
    return {p.normal_x, p.normal_y, p.normal_z};
  }
};

}  // namespace agrisee
