// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Poses from matrices and quaternions that a calibration tool has printed: rounded ones are put right, wrong ones are
/// refused by name. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/pose.hpp>

#include <string>
#include <vector>

namespace agrisee {

/// Poses whose rotation matrices are off by no more are made rigid instead of refused: calibration tools print three to
/// six decimals.
constexpr double kRigidTolerance = 1e-3;

/// The orthonormal matrix nearest to a pose's rotation matrix (singular value decomposition).
Eigen::Matrix3d nearest_orthonormal(const Pose& pose);

/// How far a pose's rotation matrix is from orthonormal: the largest difference of an entry from that of the nearest
/// orthonormal matrix.
double rigid_error(const Pose& pose);

/// A rigid pose from one whose rotation matrix may be rounded. If the matrix is off by less than 1e-6 (is_rigid), the
/// pose is returned as it is; if it is off by at most kRigidTolerance, with the nearest rotation, and a note is added.
/// @param pose rotation and translation (m)
/// @param name how messages call the pose, e.g. "tool0_T_optical"
/// @param notes receives a sentence when the rotation was changed; may be null
/// @throws InputError that says what is wrong with the pose and by how much
Pose made_rigid(const Pose& pose, const std::string& name, std::vector<std::string>* notes = nullptr);

/// Pose from a 4 x 4 matrix, as calibration tools print it.
/// @param matrix rotation and translation (m) over a last row of 0 0 0 1
/// @param name, notes as of made_rigid
/// @throws InputError as made_rigid, or for another last row
Pose pose_from_matrix(const Unaligned<4, 4>& matrix, const std::string& name = "the matrix",
                      std::vector<std::string>* notes = nullptr);

/// Pose from a translation (m) and a quaternion x y z w, which is normalized.
/// @param xyz translation (m)
/// @param xyzw quaternion; its length may differ from 1 by kRigidTolerance
/// @param name, notes as of made_rigid
/// @throws InputError for another length, or for NaN or infinity
Pose pose_from_xyz_quaternion(const Eigen::Vector3d& xyz, const Unaligned<4, 1>& xyzw,
                              const std::string& name = "the pose", std::vector<std::string>* notes = nullptr);

}  // namespace agrisee
