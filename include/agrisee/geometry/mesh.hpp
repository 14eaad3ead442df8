// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangle meshes: moving, joining, area and volume.
#pragma once

#include <agrisee/core/pose.hpp>

#include <array>

namespace agrisee {

/// A triangle mesh. The vertices of a triangle are counter-clockwise as seen from outside.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;                ///< m
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`
};

/// A copy of the mesh, scaled about the origin of its frame, then moved by `pose`.
inline Mesh transformed(const Mesh& mesh, const Pose& pose, double scale = 1.0) {
  Mesh out = mesh;
  for (Eigen::Vector3f& v : out.vertices) v = (pose * (scale * v.cast<double>())).cast<float>();
  return out;
}

/// Appends the mesh `other` to `mesh`.
inline void append(Mesh& mesh, const Mesh& other) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

/// Total area of the triangles (m2).
inline double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    sum += 0.5 * (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a).norm();
  }
  return sum;
}

/// Volume (m3) enclosed by a closed mesh, by the divergence theorem.
inline double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles)
    sum += mesh.vertices[t[0]].cast<double>().dot(
        mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>()));
  return sum / 6.0;
}

}  // namespace agrisee
