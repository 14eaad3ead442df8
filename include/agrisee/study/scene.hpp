// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A simulated scene: meshes in world coordinates, each with its class and, if it is a fruit, its identity.
#pragma once

#include <agrisee/core/types.hpp>
#include <agrisee/geometry/mesh.hpp>

#include <optional>
#include <vector>

namespace agrisee::study {

/// What an object is. Only the simulation and the evaluation read this; the pipeline never does.
enum class ObjectClass { fruit, stem, leaf, other };

/// One object of a scene.
struct Object {
  int id = 0;                            ///< positive and unique for a fruit, 0 for everything else
  ObjectClass cls = ObjectClass::other;  ///< class of the object
  Mesh mesh;                             ///< its surface (m, world)
  /// Its material, if not that of its class: light enters a leaf, fruit may reflect it.
  std::optional<ObjectClass> material = std::nullopt;
  std::optional<double> ripeness = std::nullopt;  ///< of a fruit: ripe share (0..1) of its surface
  std::optional<Rgb> color = std::nullopt;        ///< of its surface; empty: by class, and that of a fruit by ripeness
};

/// All objects that a sensor can see or that can occlude others.
struct Scene {
  std::vector<Object> objects;  ///< in any order
};

}  // namespace agrisee::study
