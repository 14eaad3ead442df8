// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads rigid poses from YAML, in the forms in which calibration tools write them.
#pragma once

#include <agrisee/core/pose.hpp>

#include <string>
#include <vector>

#include "io/formats/yaml_map.hpp"

namespace agrisee::io {

/// Roll, pitch and yaw (rad). @throws FileError for angles beyond a full turn, which must be degrees
Eigen::Vector3d read_rpy(const YamlValue& value);

/// The pose that a YAML value states (m, rad), in one of these forms:
///
/// - a matrix: four rows of four numbers (or the first three), or 16 numbers row by row; as it is, or as
///   `{matrix: ...}`;
/// - `{xyz: [x, y, z], rpy: [roll, pitch, yaw]}`: as in URDF, see pose_from_xyz_rpy;
/// - `{xyz: [x, y, z], quaternion: [x, y, z, w]}`.
/// @param value    the YAML value
/// @param warnings receives a sentence when a rotation was rounded and has been put right (core/rigid_pose.hpp)
/// @throws FileError for another form, and for a pose that is not rigid to kRigidTolerance
Pose read_pose(const YamlValue& value, std::vector<std::string>& warnings);

}  // namespace agrisee::io
