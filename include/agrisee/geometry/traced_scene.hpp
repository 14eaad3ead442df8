// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A scene made ready for rays: all objects in one tree. World frame, metres. Built in O(n log n) for n triangles.
#pragma once

#include <agrisee/geometry/bvh.hpp>
#include <agrisee/geometry/scene.hpp>

namespace agrisee {

/// All triangles of a scene, numbered object by object in the scene's order. It copies what it needs, so the scene may
/// go away.
class TracedScene {
 public:
  /// @param scene its objects
  /// @param threads the result does not depend on it
  /// @throws InputError when a mesh names a vertex that it does not have; the object's index is named
  explicit TracedScene(const Scene& scene, int threads = 1) {
    Mesh all;
    std::size_t vertices = 0, triangles = 0;
    for (const Object& object : scene.objects) {
      vertices += object.mesh.vertices.size();
      triangles += object.mesh.triangles.size();
    }
    check_input(vertices < std::numeric_limits<std::uint32_t>::max(), "traced scene: too many vertices");
    all.vertices.reserve(vertices);
    all.triangles.reserve(triangles);
    objects_.reserve(triangles);
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      const Mesh& mesh = scene.objects[o].mesh;
      for (const auto& t : mesh.triangles)
        if (std::max({t[0], t[1], t[2]}) >= mesh.vertices.size())
          throw InputError("traced scene: object " + std::to_string(o) + " names vertex " +
                           std::to_string(std::max({t[0], t[1], t[2]})) + " of " +
                           std::to_string(mesh.vertices.size()));
      append(all, mesh);
      objects_.resize(all.triangles.size(), static_cast<std::uint32_t>(o));
    }
    normals_.reserve(triangles);
    for (const auto& t : all.triangles) {
      const Eigen::Vector3d n = area_normal({all.vertices[t[0]], all.vertices[t[1]], all.vertices[t[2]]});
      const double length = n.norm();
      normals_.push_back(std::isfinite(length) && length > 0.0 ? Eigen::Vector3f((n / length).cast<float>())
                                                               : Eigen::Vector3f(Eigen::Vector3f::Zero()));
    }
    bvh_ = Bvh(all, threads);
  }

  /// The tree over all triangles.
  const Bvh& bvh() const { return bvh_; }
  /// Number of triangles of all objects, the degenerate ones included.
  std::size_t size() const { return objects_.size(); }
  /// Index in `Scene::objects` of the object that triangle i < size() belongs to.
  std::uint32_t object(std::uint32_t i) const { return objects_[i]; }
  /// Outward unit normal of triangle i < size(); zero where it is degenerate.
  const Eigen::Vector3f& normal(std::uint32_t i) const { return normals_[i]; }

 private:
  Bvh bvh_;
  std::vector<std::uint32_t> objects_;
  std::vector<Eigen::Vector3f> normals_;
};

}  // namespace agrisee
