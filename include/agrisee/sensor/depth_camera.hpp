// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A depth camera: its image, its range, and the steepest surface that it still measures.
#pragma once

#include <agrisee/sensor/intrinsics.hpp>

namespace agrisee::sensor {

/// A depth camera. Fill it in with your own calibration, or start from a model such as l515().
struct DepthCamera {
  Intrinsics intrinsics;           ///< of the depth image
  double range_min = 0.0;          ///< shortest distance along the ray that is measured (m)
  double range_max = 10.0;         ///< longest distance along the ray that is measured (m)
  double max_incidence = deg(80);  ///< surfaces give no return beyond this angle between ray and normal (rad)

  /// @throws ParameterError naming the field
  void check() const {
    check_parameter(std::isfinite(range_min) && range_min >= 0.0, "sensor.range_min", "0 or more", range_min);
    check_parameter(std::isfinite(range_max) && range_max > range_min, "sensor.range_max", "above range_min",
                    range_max);
    check_parameter(max_incidence > 0.0 && max_incidence <= 0.5 * kPi, "sensor.max_incidence", "in (0, pi/2]",
                    max_incidence);
  }
};

/// An Intel RealSense L515: 1024 x 768 pixels over 70 x 55 degrees, 0.25 to 9 m (data sheet), surfaces seen below 80
/// degrees of incidence.
inline DepthCamera l515() {
  DepthCamera camera;
  camera.intrinsics = intrinsics_from_fov(1024, 768, deg(70), deg(55));
  camera.range_min = 0.25;
  camera.range_max = 9.0;
  return camera;
}

}  // namespace agrisee::sensor
