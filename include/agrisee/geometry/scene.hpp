// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a simulated sensor looks at: meshes with their class and instance, the ground truth of studies.
#pragma once

#include <agrisee/geometry/mesh.hpp>

#include <string>

namespace agrisee {

/// What an object is. Only the evaluation reads it, the pipeline never does.
enum class ObjectClass { fruit, stem, leaf, other };

/// One object of a scene; its mesh is in world coordinates.
struct Object {
  int id = 0;                            ///< unique and positive for fruit, 0 for everything else
  ObjectClass cls = ObjectClass::other;  ///< what it is
  Mesh mesh;                             ///< world
};

/// Everything that the sensor sees and that hides other things from it.
struct Scene {
  std::vector<Object> objects;  ///< all that the sensor sees
};

}  // namespace agrisee
