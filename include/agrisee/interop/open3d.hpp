// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// `open3d::geometry::PointCloud` as a cloud, in place, with its normals where it has them. Needs Open3D's headers;
/// links nothing. (A position tensor of `open3d::t::geometry::PointCloud` on the CPU is an `Eigen::Map` of a row a
/// point.)
#pragma once

#include <agrisee/core/traits.hpp>

#include <open3d/geometry/PointCloud.h>

namespace agrisee {

/// Open3D's clouds.
template <>
struct CloudTraits<open3d::geometry::PointCloud> {
  /// Of coordinates.
  using Scalar = double;
  /// Number of points.
  static std::size_t size(const open3d::geometry::PointCloud& c) { return c.points_.size(); }
  /// Point i (m).
  static const Eigen::Vector3d& point(const open3d::geometry::PointCloud& c, std::size_t i) { return c.points_[i]; }
  /// Normal i; zero where it is not known.
  static Eigen::Vector3d normal(const open3d::geometry::PointCloud& c, std::size_t i) {
    return c.HasNormals() ? c.normals_[i] : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
};

}  // namespace agrisee
