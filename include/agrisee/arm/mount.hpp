// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where an arm stands, how it holds its sensor, and which spaces are forbidden. Reachability and collisions depend on
/// these.
#pragma once

#include <agrisee/arm/limits.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/overlap.hpp>

#include <vector>

namespace agrisee::arm {

/// The housing of the sensor: a flat-ended cylinder around the optical axis, with the optical center in its front face.
/// The defaults are the L515's diameter of 61 mm and depth of 26 mm (data sheet).
struct SensorBody {
  double radius = 0.0305;  ///< m
  double depth = 0.026;    ///< extent behind the optical center (m)
};

/// A mounted arm with its sensor, and the spaces that neither may enter.
struct Mount {
  Pose world_T_base = Pose::Identity();       ///< pose of base_link in world
  Pose tool0_T_optical = default_hand_eye();  ///< hand-eye transform
  std::vector<KeepOut> keep_out;              ///< forbidden spaces in world
  JointLimits limits;                         ///< of joint angles and speeds
  SensorBody sensor;                          ///< housing of the sensor

  /// @throws ParameterError with the name of the field that is out of range
  void check() const {
    if (!is_rigid(world_T_base)) throw ParameterError("world_T_base must be a finite rigid pose");
    if (!is_rigid(tool0_T_optical)) throw ParameterError("tool0_T_optical must be a finite rigid pose");
    limits.check();
    check_parameter(sensor.radius > 0.0 && std::isfinite(sensor.radius), "sensor.radius", "positive", sensor.radius);
    check_parameter(sensor.depth > 0.0 && std::isfinite(sensor.depth), "sensor.depth", "positive", sensor.depth);
    for (const KeepOut& space : keep_out) space.check();
  }
};

/// The housing, in world, of a sensor at world_T_optical.
inline OrientedCylinder housing(const SensorBody& sensor, const Pose& world_T_optical) {
  const Eigen::Vector3d axis = world_T_optical.linear().col(2);
  return {world_T_optical.translation() - 0.5 * sensor.depth * axis, axis, sensor.radius, sensor.depth};
}

}  // namespace agrisee::arm
