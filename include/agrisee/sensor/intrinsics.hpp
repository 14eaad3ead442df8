// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The pinhole camera.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee::sensor {

/// A pinhole without distortion. Pixel (u, v) is column u of row v, its centre at integer coordinates.
struct Intrinsics {
  int width = 0;    ///< pixels
  int height = 0;   ///< pixels
  double fx = 0.0;  ///< focal length along u, pixels
  double fy = 0.0;  ///< along v
  double cx = 0.0;  ///< principal point, pixels
  double cy = 0.0;  ///< its row

  /// Number of pixels.
  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  /// Point on the ray of a pixel at z = 1 in the optical frame (z forward, x right, y down).
  Eigen::Vector3d ray(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1.0}; }
  /// Pixel coordinates of a point in the optical frame with z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const { return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy}; }
};

/// Intrinsics from full opening angles (rad) over the whole image, the principal point in its middle.
/// @throws ParameterError for sizes below one pixel or angles outside (0, pi)
inline Intrinsics intrinsics_from_fov(int width, int height, double fov_x, double fov_y) {
  check_parameter(width >= 1, "sensor width", ">= 1", width);
  check_parameter(height >= 1, "sensor height", ">= 1", height);
  check_parameter(fov_x > 0 && fov_x < kPi, "horizontal field of view", "in (0, pi)", fov_x);
  check_parameter(fov_y > 0 && fov_y < kPi, "vertical field of view", "in (0, pi)", fov_y);
  Intrinsics k;
  k.width = width;
  k.height = height;
  k.fx = 0.5 * width / std::tan(0.5 * fov_x);
  k.fy = 0.5 * height / std::tan(0.5 * fov_y);
  k.cx = 0.5 * (width - 1);
  k.cy = 0.5 * (height - 1);
  return k;
}

}  // namespace agrisee::sensor
