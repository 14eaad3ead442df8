// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where an arm stands, how it holds its sensor, and which spaces are forbidden. Reachability and collisions depend on
/// these. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/arm/ur_model.hpp>
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
  UrModel model;                              ///< which arm it is, with its limits
  SensorBody sensor;                          ///< housing of the sensor

  /// @throws ParameterError with the name of the field that is out of range
  void check() const;
};

/// Whether a frame's origin and z axis lie on the axis of the last joint, which then only turns the frame about its z.
bool on_last_axis(const Pose& tool0_T_frame);

/// The housing, in world, of a sensor at world_T_optical.
OrientedCylinder housing(const SensorBody& sensor, const Pose& world_T_optical);

}  // namespace agrisee::arm
