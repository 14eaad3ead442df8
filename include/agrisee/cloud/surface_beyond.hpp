// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether a body is only the end of something longer, such as a post: then the surface goes on outside of the body.
/// Metres. Cost: linear in the points near the body.
#pragma once

#include <agrisee/cloud/body_verdict.hpp>
#include <agrisee/cloud/outside_surface.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <bitset>

namespace agrisee {

/// Share (0..1) of the directions from a body's center without points of its own in which other points lie outside of
/// it, 0.2 to 0.3 radii from its surface and beyond its points' noise, with normals like its own.
/// @param cloud points (m) with normals
/// @param grid of the cloud
/// @param labels one per point
/// @param label of the body's own points
template <typename S>
double surface_beyond(const PointCloud<S>& cloud, const Grid<S>& grid, const Labels& labels, int label,
                      const Ellipsoid& body) {
  constexpr double kFar = 0.3, kNoise = 4.0;  // radii; standard deviations
  const double r = body.mean_radius();
  std::bitset<DirectionBins::kCount> own;
  detail::OutsideSurface outside;
  detail::visit_near(grid, body, [&](Index index) {
    const auto i = static_cast<std::size_t>(index);
    const Eigen::Vector3d p = cloud.points[i].template cast<double>();
    const int bin = DirectionBins::bin(p - body.center);
    const auto foot = body.foot(p);
    if (labels[i] == label) {
      own.set(static_cast<std::size_t>(bin));
      outside.add_noise(foot.distance);
    } else if (foot.distance < kFar * r &&
               foot.normal.dot(cloud.normals[i].template cast<double>()) > detail::OutsideSurface::kFollows) {
      outside.add(bin, foot.distance);
    }
  });
  return outside.share(own, r, 0.0, kNoise);
}

}  // namespace agrisee
