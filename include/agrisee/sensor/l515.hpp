// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The Intel RealSense L515.
#pragma once

#include <agrisee/sensor/intrinsics.hpp>

namespace agrisee::sensor {

/// An L515: 1024 x 768 pixels over 70 x 55 degrees, 0.25 to 9 m (published figures), surfaces seen below 80 degrees of incidence.
struct L515 {
  Intrinsics intrinsics = intrinsics_from_fov(1024, 768, deg(70), deg(55));
  double range_min = 0.25;         ///< shortest distance along the ray (m)
  double range_max = 9.0;          ///< longest distance along the ray (m)
  double max_incidence = deg(80);  ///< largest angle between ray and surface normal that still returns (rad)
};

}  // namespace agrisee::sensor
