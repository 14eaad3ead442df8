// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/study/ground_truth.hpp>
#include <agrisee/study/mesh_moments.hpp>

namespace agrisee::study {

GroundTruth ground_truth(const Scene& scene) {
  GroundTruth truth;
  for (const Object& object : scene.objects) {
    if (object.cls != ObjectClass::fruit) continue;
    check_input(object.id > 0, "scene: a fruit's id must be positive");
    for (const TrueFruit& other : truth.fruits) check_input(other.id != object.id, "scene: two fruits share an id");
    const MeshMoments m = mesh_moments(object.mesh);
    TrueFruit fruit;
    fruit.id = object.id;
    fruit.center = m.center;
    fruit.radii = m.radii;
    fruit.axes = m.axes;
    fruit.volume = m.volume;
    fruit.ripeness = object.ripeness;
    truth.fruits.push_back(fruit);
  }
  return truth;
}

}  // namespace agrisee::study
