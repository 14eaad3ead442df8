// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the points of a ready cloud were seen from. Metres, the cloud's frame.
#pragma once

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace agrisee {

/// What is known of a ready cloud beside its points.
struct CloudOrigin {
  std::vector<Eigen::Vector3d>
      sensors;  ///< sensor position (m) of each view that `cloud.views` refers to; may be empty
  std::optional<Eigen::Vector3d> viewpoint;  ///< one sensor position (m) for all points, where there are no views
  bool check_normals =
      false;  ///< turn the cloud's own normals, too, where they face away from where they were seen from
  Eigen::Vector3d cluster_origin = Eigen::Vector3d::Zero();  ///< origin of the cluster frame in world (m)
};

}  // namespace agrisee
