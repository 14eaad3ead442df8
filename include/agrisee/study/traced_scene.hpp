// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A scene prepared for ray casting: the triangles of all its objects in one bounding volume hierarchy. World frame,
/// metres. It takes O(n log n) to build for n triangles.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/study/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace agrisee {
class Bvh;
}

namespace agrisee::study {

/// What a camera's image shows of an object, beside its shape.
struct Look {
  int id = 0;                            ///< Object::id
  ObjectClass cls = ObjectClass::other;  ///< Object::cls
  std::optional<double> ripeness = {};   ///< Object::ripeness
  std::optional<Rgb> color = {};         ///< Object::color
  Aabb box = {};                         ///< about it (m, world)
};

/// All triangles of a scene, numbered object by object in the order of Scene::objects. The triangles are copied, so the
/// scene need not outlive this object. It cannot be changed: any number of threads may query it at once, and its copies
/// share one tree.
class TracedScene {
 public:
  /// @param scene its objects are read
  /// @param threads number of threads; the result does not depend on it
  /// @throws InputError if a triangle refers to a vertex that its mesh does not have; the message names the object by
  /// its index
  explicit TracedScene(const Scene& scene, int threads = 1);

  /// The tree over all triangles. Include geometry/bvh.hpp to query it.
  const Bvh& bvh() const { return *bvh_; }
  /// Number of triangles of all objects, degenerate ones included.
  std::size_t size() const { return objects_.size(); }
  /// Index in Scene::objects of the object that triangle i < size() belongs to.
  std::uint32_t object(std::uint32_t i) const { return objects_[i]; }
  /// What the objects are made of, by their index in Scene::objects.
  const std::vector<ObjectClass>& materials() const { return materials_; }
  /// What the objects look like, by their index in Scene::objects.
  const std::vector<Look>& looks() const { return looks_; }
  /// A tree over the triangles of all objects that are not made of leaf. Empty if no object is.
  const Bvh& solids() const { return *solids_; }
  /// Outward unit normal of triangle i < size(); zero if the triangle is degenerate.
  const Eigen::Vector3f& normal(std::uint32_t i) const { return normals_[i]; }

 private:
  std::shared_ptr<const Bvh> bvh_, solids_;
  std::vector<std::uint32_t> objects_;
  std::vector<Eigen::Vector3f> normals_;
  std::vector<ObjectClass> materials_;
  std::vector<Look> looks_;
};

}  // namespace agrisee::study
