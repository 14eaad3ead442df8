// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How an arm stands in its cell and how it holds its sensor: what reach and collisions depend on.
#pragma once

#include <agrisee/arm/limits.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/overlap.hpp>

#include <vector>

namespace agrisee::arm {

/// The sensor's housing: a flat-ended cylinder about the optical axis whose front face holds the optical centre. The
/// defaults are the L515's 61 mm diameter and 26 mm depth (data sheet).
struct SensorBody {
  double radius = 0.0305;  ///< m
  double depth = 0.026;    ///< behind the optical centre (m)
};

/// A mounted arm with its sensor, and the space that neither may enter.
struct Mount {
  Pose world_T_base = Pose::Identity();                                                 ///< base_link in world
  Pose tool0_T_optical = pose_from_xyz_rpy({0.0, 0.0, 0.03}, Eigen::Vector3d::Zero());  ///< hand-eye transform
  std::vector<KeepOut> keep_out;                                                        ///< solids in world
  JointLimits limits;                                                                   ///< positions and speeds
  SensorBody sensor;                                                                    ///< its housing

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    if (!is_rigid(world_T_base)) throw ParameterError("world_T_base must be a finite rigid pose");
    if (!is_rigid(tool0_T_optical)) throw ParameterError("tool0_T_optical must be a finite rigid pose");
    limits.check();
    check_parameter(sensor.radius > 0.0 && std::isfinite(sensor.radius), "sensor.radius", "positive", sensor.radius);
    check_parameter(sensor.depth > 0.0 && std::isfinite(sensor.depth), "sensor.depth", "positive", sensor.depth);
    for (const KeepOut& space : keep_out) space.check();
  }
};

/// The sensor's housing in world, for a sensor at world_T_optical.
inline OrientedCylinder housing(const SensorBody& sensor, const Pose& world_T_optical) {
  const Eigen::Vector3d axis = world_T_optical.linear().col(2);
  return {world_T_optical.translation() - 0.5 * sensor.depth * axis, axis, sensor.radius, sensor.depth};
}

}  // namespace agrisee::arm
