// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A depth camera: its image, its range, and the steepest surface that it still measures.
#pragma once

#include <agrisee/sensor/intrinsics.hpp>

#include <array>
#include <string>

namespace agrisee::sensor {

/// A depth camera. Fill it in with your own calibration, or start from a model such as l515().
struct DepthCamera {
  Intrinsics intrinsics;           ///< of the depth image; there are no defaults
  double range_min = 0.0;          ///< shortest distance along the ray that is measured (m)
  double range_max = 10.0;         ///< longest distance along the ray that is measured (m)
  double max_incidence = deg(80);  ///< surfaces give no return beyond this angle between ray and normal (rad)
  double housing_radius = 0.0305;  ///< of the cylinder about the optical axis that holds the housing (m); an L515's
  double housing_depth = 0.026;    ///< how far the housing extends behind the optical center (m); an L515's

  /// @throws ParameterError naming the field
  void check() const {
    const Intrinsics& k = intrinsics;
    check_parameter(k.width >= 1, "sensor.intrinsics.width", "1 or more", k.width);
    check_parameter(k.height >= 1, "sensor.intrinsics.height", "1 or more", k.height);
    check_parameter(std::isfinite(k.fx) && k.fx > 0.0, "sensor.intrinsics.fx", "positive", k.fx);
    check_parameter(std::isfinite(k.fy) && k.fy > 0.0, "sensor.intrinsics.fy", "positive", k.fy);
    check_parameter(std::isfinite(k.cx), "sensor.intrinsics.cx", "finite", k.cx);
    check_parameter(std::isfinite(k.cy), "sensor.intrinsics.cy", "finite", k.cy);
    check_parameter(std::isfinite(housing_radius) && housing_radius > 0.0, "sensor.housing_radius", "positive",
                    housing_radius);
    check_parameter(std::isfinite(housing_depth) && housing_depth > 0.0, "sensor.housing_depth", "positive",
                    housing_depth);
    check_parameter(std::isfinite(range_min) && range_min >= 0.0, "sensor.range_min", "0 or more", range_min);
    check_parameter(range_min <= 10.0, "sensor.range_min", "10 m or less (is it in millimetres?)", range_min);
    check_parameter(std::isfinite(range_max) && range_max > range_min, "sensor.range_max", "above range_min",
                    range_max);
    check_parameter(max_incidence > 0.0 && max_incidence <= 0.5 * kPi, "sensor.max_incidence", "in (0, pi/2]",
                    max_incidence);
  }
};

/// The published figures of a camera's depth image.
struct CameraModel {
  const char* name;       ///< as in scene files
  int width;              ///< of the image (pixels)
  int height;             ///< of the image (pixels)
  double fov_x_deg;       ///< full horizontal opening angle (degrees)
  double fov_y_deg;       ///< full vertical opening angle (degrees)
  double range_min;       ///< m, see DepthCamera
  double range_max;       ///< m, see DepthCamera
  double housing_radius;  ///< m, see DepthCamera
  double housing_depth;   ///< m, see DepthCamera

  /// A camera with these figures.
  DepthCamera camera() const {
    DepthCamera out;
    out.intrinsics = intrinsics_from_fov(width, height, deg(fov_x_deg), deg(fov_y_deg));
    out.range_min = range_min;
    out.range_max = range_max;
    out.housing_radius = housing_radius;
    out.housing_depth = housing_depth;
    return out;
  }
};

/// The cameras that are known by name, with the figures of their data sheets: Intel RealSense L515; Intel RealSense
/// D405 at 1280 x 720, whose data sheet calls 0.5 m the end of the ideal range; Microsoft Azure Kinect in the narrow,
/// unbinned mode. Depth images of a real camera have the intrinsics of its calibration.
constexpr std::array<CameraModel, 3> kCameraModels{{{"l515", 1024, 768, 70, 55, 0.25, 9.0, 0.0305, 0.026},
                                                    {"d405", 1280, 720, 84, 58, 0.1, 0.5, 0.03, 0.023},
                                                    {"azure", 640, 576, 75, 65, 0.5, 3.86, 0.065, 0.126}}};

/// An Intel RealSense L515: 1024 x 768 pixels over 70 x 55 degrees, 0.25 to 9 m (data sheet), surfaces seen below 80
/// degrees of incidence.
inline DepthCamera l515() { return kCameraModels[0].camera(); }

}  // namespace agrisee::sensor
