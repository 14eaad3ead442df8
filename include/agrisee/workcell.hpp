// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a scan takes place: the arm and its mounting, the sensor, the volume to scan and the space to keep out of.
#pragma once

#include <agrisee/arm/ur_model.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/geometry/primitives.hpp>
#include <agrisee/sensor/depth_camera.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee {

/// Everything of a scene file but its objects; see the scene format.
struct Workcell {
  std::string name;                           ///< as in run.json
  arm::UrModel arm;                           ///< a UR3 unless set otherwise
  Pose world_T_base = Pose::Identity();       ///< the arm's base_link in world
  Pose tool0_T_optical = default_hand_eye();  ///< hand-eye transform
  /// The gripper's tool frame in tool0: origin at the gripping point, z ahead, towards the fruit. Empty: the optical
  /// frame, moved ahead by `picking.tool_length`.
  std::optional<Pose> tool0_T_tool;
  Joints start = (Joints() << 0.0, -1.57, 1.57, -1.57, -1.57, 0.0).finished();  ///< joints before the first move (rad)
  sensor::DepthCamera sensor = sensor::l515();                                  ///< the camera that the arm carries
  Aabb scan_volume;                                                             ///< world
  std::vector<KeepOut> keep_out;                                                ///< neither arm nor sensor may enter
};

}  // namespace agrisee
