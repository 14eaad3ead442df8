// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The angle between two directions, and between two orientations.
#pragma once

#include <agrisee/core/pose.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace agrisee {

/// The angle (rad) between two vectors of any length; exact for small angles, too. NaN if a coordinate is not finite.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The angle (rad, up to pi) of the rotation that takes the orientation of one pose to that of another.
inline double turn_between(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

}  // namespace agrisee
