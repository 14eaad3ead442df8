// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From a segmented cloud to located fruit: centroids, pose frames, bodies ([1], "Localization"). Defined in
/// `agrisee::agrisee`.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>

#include <vector>

namespace agrisee {

struct Split;

/// The origin of the cluster frame {R} in world (m): the corner of the scan volume that is lowest, leftmost and
/// farthest as seen from the robot's base looking at the volume's centre ([1], "Localization"). The axes of {R} are
/// parallel to world's. "Far" is along the world axis, x or y, to which the line of sight is nearest.
/// @param volume the scan volume (world)
/// @param robot the robot's base (m, world)
Eigen::Vector3d cluster_origin(const Aabb& volume, const Eigen::Vector3d& robot);

/// The fruit of a segmented cloud, numbered from the top of the truss down.
/// @param cloud points (m, world) with normals
/// @param split what `split` found in that cloud
/// @param cluster_origin the origin of the cluster frame {R} in world (m)
/// @param parameters of all stages
/// @param labels receives one label a point: the fruit's id, or 0
std::vector<Fruit> locate(const Cloud& cloud, const Split& split, const Eigen::Vector3d& cluster_origin,
                          const Parameters& parameters, Labels& labels);

}  // namespace agrisee
