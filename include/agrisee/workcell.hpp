// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The workcell of a scan: the arm and its mounting, the sensor, the volume to scan and the spaces to keep out of.
#pragma once

#include <agrisee/arm/ur.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/geometry/primitives.hpp>
#include <agrisee/sensor/depth_camera.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee {

/// The workcell, as in a scene file without its objects (docs/formats.md).
struct Workcell {
  std::string name;                           ///< `scene` in run.json
  arm::UrModel arm;                           ///< a UR3 unless set otherwise
  Pose world_T_base = Pose::Identity();       ///< the arm's base_link in world
  Pose tool0_T_optical = default_hand_eye();  ///< hand-eye transform
  /// The gripper's tool frame in tool0: origin at the gripping point, z forward, towards the fruit. Empty: the optical
  /// frame, moved forward by `picking.tool_length`.
  std::optional<Pose> tool0_T_tool;
  Joints start = (Joints() << 0.0, -1.57, 1.57, -1.57, -1.57, 0.0).finished();  ///< joints before the first move (rad)
  sensor::DepthCamera sensor = sensor::l515();                                  ///< the camera that the arm carries
  Aabb scan_volume;                                                             ///< what is scanned (m, world)
  std::vector<KeepOut> keep_out;                                                ///< neither arm nor sensor may enter
};

/// What is wrong with the pose in tool0 of something that the flange holds: that it is more than 3 m away. Empty if
/// nothing is.
/// @param what is held: "the camera"
inline std::optional<std::string> fault_of_held(const Pose& tool0_T_held, const std::string& what) {
  constexpr double kFarthest = 3.0;  // m
  const double held = tool0_T_held.translation().norm();
  if (!(held > kFarthest)) return std::nullopt;
  return what + " is " + metres(held) + " from the flange: is it in millimetres? Lengths have to be in metres";
}

/// What is wrong with the hand-eye transform: a camera more than 3 m from the flange, which no arm holds. Empty if
/// nothing is.
inline std::optional<std::string> fault_of_hand_eye(const Workcell& workcell) {
  return fault_of_held(workcell.tool0_T_optical, "the camera");
}

/// What is wrong with the gripper's tool frame: a gripping point more than 3 m from the flange. Empty if nothing is.
inline std::optional<std::string> fault_of_gripper(const Workcell& workcell) {
  if (!workcell.tool0_T_tool) return std::nullopt;
  return fault_of_held(*workcell.tool0_T_tool, "the gripping point");
}

/// The pose of the optical frame in world at joint angles `q` (rad), by the model of the arm and the hand-eye
/// transform.
/// @throws InputError if a joint angle is not finite
inline Pose optical_pose(const Workcell& workcell, const Joints& q) {
  return workcell.world_T_base * arm::forward(q, workcell.arm) * workcell.tool0_T_optical;
}

}  // namespace agrisee
