// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The clouds in the other libraries' own types. Include their headers first.
#pragma once

#include "peers.hpp"

namespace agrisee::peers {

/// cloud(n) without normals.
inline const Cloud& bare_cloud(std::size_t n) {
  static std::map<std::size_t, Cloud> clouds;
  Cloud& c = clouds[n];
  if (c.points.empty()) c.points = cloud(n).points;
  return c;
}

#ifdef PEERS_PCL
inline pcl::PointCloud<pcl::PointXYZ>::Ptr pcl_cloud(const Cloud& cloud) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr out(new pcl::PointCloud<pcl::PointXYZ>);
  out->reserve(cloud.size());
  for (const auto& p : cloud.points) out->emplace_back(p.x(), p.y(), p.z());
  return out;
}
inline pcl::PointCloud<pcl::PointXYZ>::Ptr pcl_cloud(std::size_t n) {
  static std::map<std::size_t, pcl::PointCloud<pcl::PointXYZ>::Ptr> clouds;
  auto& c = clouds[n];
  if (!c) c = pcl_cloud(cloud(n));
  return c;
}
#endif

#ifdef PEERS_OPEN3D
inline open3d::geometry::PointCloud open3d_cloud(const Cloud& cloud) {
  open3d::geometry::PointCloud out;
  for (const auto& p : cloud.points) out.points_.push_back(p.cast<double>());
  return out;
}
inline open3d::geometry::PointCloud& open3d_cloud(std::size_t n) {
  static std::map<std::size_t, open3d::geometry::PointCloud> clouds;
  auto& c = clouds[n];
  if (c.points_.empty()) c = open3d_cloud(cloud(n));
  return c;
}
#endif

}  // namespace agrisee::peers
