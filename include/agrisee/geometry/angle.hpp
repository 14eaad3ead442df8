// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The angle between two directions.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace agrisee {

/// The angle (rad) between two vectors of any length; exact for small angles, too. NaN if a coordinate is not finite.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace agrisee
