// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace agrisee::study {

namespace {

/// Throws InputError if a triangle of the mesh refers to a vertex that does not exist.
void check_vertices(const Mesh& mesh, std::size_t object) {
  for (const auto& t : mesh.triangles) {
    const std::uint32_t largest = std::max({t[0], t[1], t[2]});
    if (largest >= mesh.vertices.size())
      throw InputError("traced scene: object " + std::to_string(object) + " names vertex " + std::to_string(largest) +
                       " of " + std::to_string(mesh.vertices.size()));
  }
}

/// Unit normal of a triangle, zero if it is degenerate.
Eigen::Vector3f unit_normal(const Triangle& triangle) {
  const Eigen::Vector3d n = area_normal(triangle);
  const double length = n.norm();
  if (!std::isfinite(length) || !(length > 0.0)) return Eigen::Vector3f::Zero();
  return (n / length).cast<float>();
}

}  // namespace

TracedScene::TracedScene(const Scene& scene, int threads) {
  std::size_t vertices = 0, triangles = 0;
  for (const Object& object : scene.objects) {
    vertices += object.mesh.vertices.size();
    triangles += object.mesh.triangles.size();
  }
  check_input(vertices < std::numeric_limits<std::uint32_t>::max(), "traced scene: too many vertices");
  Mesh all, solid;
  all.vertices.reserve(vertices);
  all.triangles.reserve(triangles);
  objects_.reserve(triangles);
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    check_vertices(scene.objects[o].mesh, o);
    append(all, scene.objects[o].mesh);
    materials_.push_back(scene.objects[o].material.value_or(scene.objects[o].cls));
    const Object& object = scene.objects[o];
    looks_.push_back({object.id, object.cls, object.ripeness, object.color, bounding_box(object.mesh.vertices)});
    if (materials_.back() != ObjectClass::leaf) append(solid, scene.objects[o].mesh);
    objects_.resize(all.triangles.size(), static_cast<std::uint32_t>(o));
  }
  normals_.reserve(triangles);
  for (const auto& t : all.triangles)
    normals_.push_back(unit_normal({all.vertices[t[0]], all.vertices[t[1]], all.vertices[t[2]]}));
  bvh_ = std::make_shared<const Bvh>(all, threads);
  const bool leaves = std::find(materials_.begin(), materials_.end(), ObjectClass::leaf) != materials_.end();
  solids_ = leaves ? std::make_shared<const Bvh>(solid, threads) : std::make_shared<const Bvh>();
}

}  // namespace agrisee::study
