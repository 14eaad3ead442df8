// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the surface of a body is that its ellipsoid only approximates. Metres, world.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <optional>
#include <vector>

namespace agrisee::plan {

/// Where a body's surface can be between a point on it (m) and its center (m): at that point, or deeper if sight lines
/// pass through there. Nothing if they pass through all of the outer half of the way.
/// @param normal of the surface there, outward
std::optional<Eigen::Vector3d> carved(const Eigen::Vector3d& surface, const Eigen::Vector3d& normal,
                                      const Eigen::Vector3d& center, const std::vector<sensor::SurfaceImage>& images,
                                      const fuse::FreeSpaceParameters& free_space);

/// Whether a lobe covers a point of a body's ellipsoid (m): surface that stands out from it, up to a quarter of the
/// radius, and faces outward. A cloud without normals has none.
/// @param outward unit, from the body's center
/// @param cover how far from the line through the point the surface may be (m)
bool is_below_lobe(const Cloud& cloud, const Grid<float>& grid, const Eigen::Vector3d& point,
                   const Eigen::Vector3d& outward, double radius, float cover);

}  // namespace agrisee::plan
