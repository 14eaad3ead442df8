// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is true of the fruit of a scene. Made by the truss generator, or derived from any scene's meshes. World frame,
/// metres.
#pragma once

#include <agrisee/geometry/scene.hpp>
#include <agrisee/study/mesh_moments.hpp>

#include <optional>

namespace agrisee::study {

/// The truth of one fruit. What a mesh alone cannot tell is optional.
struct TrueFruit {
  int id = 0;                                        ///< from 1
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< volume centroid (m, world)
  Eigen::Vector3d radii =
      Eigen::Vector3d::Zero();  ///< semi-axes of the ellipsoid of equal second moments, largest first
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: their directions
  double volume = 0.0;                                 ///< m3; 0 where the mesh does not close
  std::optional<Eigen::Vector3d> growth_axis;          ///< unit, from the centre to the calyx
  std::optional<bool> hidden;                          ///< made to be behind the others as seen from the robot
  std::optional<double> visible_share;                 ///< share of its surface seen from straight in front
};

/// The truth of a scene, one entry a fruit in the order of the scene's objects.
struct GroundTruth {
  std::vector<TrueFruit> fruits;  ///< by object
};

/// The ground truth that the meshes of a scene's fruit tell: see mesh_moments().
/// @throws InputError for a fruit whose mesh has no area, an id that is not positive, or two fruits with one id
inline GroundTruth ground_truth(const Scene& scene) {
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
    truth.fruits.push_back(fruit);
  }
  return truth;
}

}  // namespace agrisee::study
