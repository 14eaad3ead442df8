// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Locates the fruit of a segmented cloud: centroids, pose frames, bodies ([1], 3.2.4). Defined in
/// `agrisee::agrisee`.
#pragma once

#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>

#include <vector>

namespace agrisee {

struct BodyCounts;
struct Ellipsoid;
struct Split;

/// The origin of the cluster frame {R} in world (m): the corner of the scan volume that is lowest, leftmost and
/// farthest as seen from the robot's base looking at the volume's center ([1], 3.2.4). The axes of {R} are
/// parallel to world's. "Far" is along the world axis, x or y, to which the line of sight is nearest.
/// @param volume the scan volume (world)
/// @param robot the robot's base (m, world)
Eigen::Vector3d cluster_origin(const Aabb& volume, const Eigen::Vector3d& robot);

/// The ellipsoid of a located body.
Ellipsoid ellipsoid_of(const Body& body);

/// The fruit of a segmented cloud, numbered truss by truss, each from the top down; the truss with the highest fruit
/// comes first.
/// @param cloud points (m, world) with normals
/// @param split the segmentation of that cloud
/// @param cluster_origin the origin of the cluster frame {R} in world (m)
/// @param parameters of all stages
/// @param labels receives one label per point: the fruit's id, or 0
/// @param is_free evidence of free space, or empty; it bounds closed surfaces where nothing was seen of them, and
///   only if it is given, bodies that are parts of something larger are left out
/// @param least_seen a body above half of the largest expected radius is no fruit if a smaller share (0..1) of its
///   surface was seen
/// @param counts if not null, a body that is no fruit moves from `taken` to the reason: `little_seen`, or `too_flat` if
///   its closed surface is that of no fruit, or if it is a part of something larger; a body without points is taken off
///   `taken` only
std::vector<Fruit> locate(const Cloud& cloud, const Split& split, const Eigen::Vector3d& cluster_origin,
                          const Parameters& parameters, Labels& labels, const IsFree& is_free = {},
                          double least_seen = 0.0, BodyCounts* counts = nullptr);

}  // namespace agrisee
