// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Bodies that the border of the scan volume cuts. The end of a trunk, a post or a stem at the border is short enough
/// to pass for a fruit. But a fruit closes towards the border, so the normals near it point at the border in part; what
/// goes on beyond it has normals along the border. Metres, the cloud's frame. Cost: linear in the points.
#pragma once

#include <agrisee/cloud/body_shape.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/geometry/aabb.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace agrisee {

/// Whether a body goes on beyond the border of the volume that its cloud was cut to.
/// @param cloud points (m) with normals
/// @param points of the body
/// @param body the ellipsoid fitted to them
/// @param volume the box (m) outside of which there are no points
/// @return true if its points reach a face of the box at which the ellipsoid would close clearly, and their normals
///   point at the face less than half as much as the ellipsoid's, beyond chance
template <typename S>
bool goes_on_beyond(const PointCloud<S>& cloud, const Indices& points, const Ellipsoid& body, const Aabb& volume) {
  constexpr double kNear = 0.25, kReaches = 0.05;  // distances from the face, in mean radii
  constexpr double kCloses = 0.1;                  // mean cosine of the ellipsoid's normals from which on it closes
  constexpr double kSure = 3.0;                    // standard errors
  constexpr std::size_t kFewest = 8;               // points near the face
  const double r = body.mean_radius();
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const double face = side < 0.0 ? volume.min[axis] : volume.max[axis];
      double nearest = kNear * r, expected = 0.0, measured = 0.0, squares = 0.0;
      std::size_t near = 0;
      for (const Index index : points) {
        const auto i = static_cast<std::size_t>(index);
        const double gap = side * (face - static_cast<double>(cloud.points[i][axis]));
        if (!(gap < kNear * r)) continue;
        nearest = std::min(nearest, gap);
        expected += side * body.normal(cloud.points[i].template cast<double>())[axis];
        const double cosine = side * static_cast<double>(cloud.normals[i][axis]);
        measured += cosine;
        squares += cosine * cosine;
        ++near;
      }
      if (near < kFewest || !(nearest < kReaches * r)) continue;
      const auto n = static_cast<double>(near);
      expected /= n;
      measured /= n;
      const double error = std::sqrt(std::max(0.0, squares / n - measured * measured) / n);
      if (expected > kCloses && measured + kSure * error < 0.5 * expected) return true;
    }
  return false;
}

}  // namespace agrisee
