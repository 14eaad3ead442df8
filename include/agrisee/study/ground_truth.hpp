// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The ground truth of a scene: what is known exactly about its fruit. The truss generator provides it, and
/// ground_truth() derives most of it from the meshes of any scene. World frame, metres.
#pragma once

#include <agrisee/study/scene.hpp>

#include <optional>
#include <vector>

namespace agrisee::study {

/// The ground truth of one fruit. The optional fields cannot be derived from a mesh; the truss generator fills them.
struct TrueFruit {
  int id = 0;                                          ///< Object::id, 1 or more
  Eigen::Vector3d center = Eigen::Vector3d::Zero();    ///< volume centroid (m, world)
  Eigen::Vector3d radii = Eigen::Vector3d::Zero();     ///< semi-axes of the ellipsoid with the same second moments (m),
                                                       ///< largest first
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: unit directions of `radii`
  double volume = 0.0;                                 ///< m3; 0 if the mesh is not closed
  std::optional<Eigen::Vector3d> growth_axis;          ///< unit vector from the center to the calyx
  std::optional<bool> hidden;                          ///< placed behind the others, as seen from the robot
  std::optional<double> visible_share;                 ///< share of its surface that is visible from frontal_eye()
  std::optional<double> ripeness = {};                 ///< share (0..1) of its surface that has turned; of the scene
};

/// The ground truth of a scene.
struct GroundTruth {
  std::vector<TrueFruit> fruits;  ///< one per fruit, in the order of Scene::objects
};

/// Computes the ground truth of a scene from the meshes of its fruit, see mesh_moments().
/// @throws InputError as mesh_moments() does, or if a fruit's id is not positive or is used twice
GroundTruth ground_truth(const Scene& scene);

}  // namespace agrisee::study
