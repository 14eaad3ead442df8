// SPDX-License-Identifier: BSD-3-Clause
// How deep meshes reach into each other, measured by rays and by distances to triangles.
#pragma once

#include <agrisee/geometry/bvh.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::shapes {

/// Parity of crossings along a crooked direction.
inline bool inside(const Bvh& bvh, const Eigen::Vector3f& p) {
  const Eigen::Vector3f direction(0.317f, 0.731f, 0.604f);
  int crossings = 0;
  float from = 0.0f;
  while (const auto hit = bvh.closest(p, direction, from)) {
    ++crossings;
    from = std::nextafter(hit->t, 1e9f) + 1e-6f;
  }
  return crossings % 2 == 1;
}

/// How deep the vertices of one mesh reach below the surface of another: true distances to the triangles (m).
inline double mesh_depth(const Mesh& mesh, const Bvh& surface) {
  double deepest = 0.0;
  const Aabb box = surface.bounds();
  for (const Eigen::Vector3f& v : mesh.vertices)
    if (box.contains(v) && inside(surface, v)) deepest = std::max(deepest, double(surface.nearest(v)->distance));
  return deepest;
}

}  // namespace agrisee::shapes
