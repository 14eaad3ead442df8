// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A fruit as it hides what is behind it. World frame, metres.
#pragma once

#include <Eigen/Core>

namespace agrisee::plan {

/// An ellipsoid that hides what is behind it.
struct Occluder {
  Eigen::Vector3f center;   ///< (m, world)
  Eigen::Matrix3f to_unit;  ///< takes the ellipsoid about its center to the unit sphere (1/m)
  float radius;             ///< of a sphere around the ellipsoid (m)
  int body;                 ///< index of its fruit
};

}  // namespace agrisee::plan
