// SPDX-License-Identifier: BSD-3-Clause
// Simple meshes for tests and benchmarks.
#pragma once

#include <agrisee/core/random.hpp>
#include <agrisee/study/scene.hpp>

namespace agrisee::shapes {

/// A closed sphere with its corners on the surface: `segments` (even) around, half as many from pole to pole;
/// segments * (segments - 2) triangles, facing outwards.
inline Mesh sphere(const Eigen::Vector3d& center, double radius, int segments) {
  Mesh mesh;
  const int rings = segments / 2;
  const auto vertex = [&](int ring, int i) {
    const double polar = kPi * ring / rings, around = kTwoPi * (i % segments) / segments;
    const Eigen::Vector3d n(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
    return Eigen::Vector3f((center + radius * n).cast<float>());
  };
  mesh.vertices.push_back(vertex(0, 0));
  for (int ring = 1; ring < rings; ++ring)
    for (int i = 0; i < segments; ++i) mesh.vertices.push_back(vertex(ring, i));
  mesh.vertices.push_back(vertex(rings, 0));
  const auto index = [&](int ring, int i) {
    if (ring == 0) return std::uint32_t{0};
    if (ring == rings) return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    return static_cast<std::uint32_t>(1 + (ring - 1) * segments + i % segments);
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int i = 0; i < segments; ++i) {
      if (ring > 0) mesh.triangles.push_back({index(ring, i), index(ring + 1, i + 1), index(ring, i + 1)});
      if (ring < rings - 1) mesh.triangles.push_back({index(ring, i), index(ring + 1, i), index(ring + 1, i + 1)});
    }
  return mesh;
}

/// A rectangle of two triangles: corner, and its two edges; facing along edge_u x edge_v.
inline Mesh rectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& edge_u, const Eigen::Vector3d& edge_v) {
  Mesh mesh;
  for (const Eigen::Vector3d& p : {corner, Eigen::Vector3d(corner + edge_u), Eigen::Vector3d(corner + edge_u + edge_v),
                                   Eigen::Vector3d(corner + edge_v)})
    mesh.vertices.push_back(p.cast<float>());
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A vector whose coordinates are evenly spread over [-scale, scale].
inline Eigen::Vector3d random_vector(Rng& rng, double scale) {
  const double x = rng.uniform(-scale, scale), y = rng.uniform(-scale, scale);
  return {x, y, rng.uniform(-scale, scale)};
}

/// n triangles of edge length about `size` (m) around the origin.
inline Mesh soup(int n, double size, std::uint64_t seed) {
  Rng rng(seed);
  Mesh mesh;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d a = random_vector(rng, 0.3);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(a.cast<float>());
    for (int c = 0; c < 2; ++c) mesh.vertices.push_back((a + random_vector(rng, size)).cast<float>());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// A scene of one object of class other.
inline study::Scene scene_of(const Mesh& mesh) {
  study::Scene scene;
  scene.objects.push_back({0, study::ObjectClass::other, mesh});
  return scene;
}

}  // namespace agrisee::shapes
