// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tests whether the curved parts of a cloud bulge towards the side of their normals, as fruit do, or away from it,
/// because the normals were turned to the wrong side. Metres. Cost: some 2000 neighborhoods.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace agrisee {

/// Share (0..1) of the curved places of a cloud that bulge towards the side of their normals.
///
/// The curvature of a place is the slope of the regression of normals on points within half of `radius_min`, 1 / r on a
/// sphere of radius r. Only places count that are curved like bodies with radii between half of `radius_min` and twice
/// `radius_max`. Nearly all of them bulge on a truss whose normals point to the sensor, about half of them on leaves.
/// @param cloud points (m) with normals
/// @param radius_min smallest expected radius (m), > 0
/// @param radius_max largest expected radius (m), > 0
/// @param samples about this many points are looked at (at most twice as many), evenly spread in index order
/// @return empty if fewer than 50 places are curved
/// @throws InputError if the cloud has no normals; Cancelled
template <typename S>
std::optional<double> convex_share(const PointCloud<S>& cloud, double radius_min, double radius_max,
                                   std::size_t samples = 2000) {
  check_input(cloud.normals.size() == cloud.points.size(), "convex_share: the cloud has no normals");
  constexpr std::size_t kEnough = 50, kNeighbors = 6;
  constexpr S kSameSurface = S(0.5);  // least cosine between the normals of a place
  if (cloud.empty()) return std::nullopt;
  const S reach = static_cast<S>(0.5 * radius_min);
  const Grid<S> grid(cloud, reach);
  std::size_t convex = 0, concave = 0;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / samples);
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    throw_if_cancelled();
    double products = 0.0, squares = 0.0;
    std::size_t neighbors = 0;
    grid.visit(cloud.points[i], reach, [&](Index other, S d_sq) {
      const Vector3<S>& normal = cloud.normals[static_cast<std::size_t>(other)];
      if (!(normal.dot(cloud.normals[i]) > kSameSurface)) return;
      products +=
          double((cloud.points[static_cast<std::size_t>(other)] - cloud.points[i]).dot(normal - cloud.normals[i]));
      squares += double(d_sq);
      ++neighbors;
    });
    if (neighbors < kNeighbors || !(squares > 0.0)) continue;
    const double curvature = products / squares, size = std::abs(curvature);
    if (!(size > 0.5 / radius_max && size < 2.0 / radius_min)) continue;
    ++(curvature > 0.0 ? convex : concave);
  }
  if (convex + concave < kEnough) return std::nullopt;
  return static_cast<double>(convex) / static_cast<double>(convex + concave);
}

}  // namespace agrisee
