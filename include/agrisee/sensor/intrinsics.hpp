// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The pinhole camera model.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

namespace agrisee::sensor {

/// A pinhole camera without distortion. Pixel (u, v) is in column u and row v; integer coordinates are the middle of a
/// pixel.
struct Intrinsics {
  int width = 0;    ///< of the image (pixels)
  int height = 0;   ///< of the image (pixels)
  double fx = 0.0;  ///< focal length along u (pixels)
  double fy = 0.0;  ///< focal length along v (pixels)
  double cx = 0.0;  ///< column of the principal point (pixels)
  double cy = 0.0;  ///< row of the principal point (pixels)

  /// Number of pixels.
  std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  /// The point at z = 1 on the ray of a pixel, in the optical frame (z forward, x right, y down).
  Eigen::Vector3d ray(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1.0}; }
  /// Pixel coordinates (u, v) of a point p (optical frame) with z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const { return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy}; }
  /// Index of a pixel inside the image, which is stored row by row.
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
  }
  /// Index of the pixel in which a point p (optical frame) is seen; none if that is outside the image or z is not
  /// positive.
  std::optional<std::size_t> pixel_of(const Eigen::Vector3d& p) const {
    if (!(p.z() > 0.0)) return std::nullopt;
    const Eigen::Vector2d uv = project(p);
    const double u = std::floor(uv.x() + 0.5), v = std::floor(uv.y() + 0.5);
    if (!(u >= 0.0 && v >= 0.0 && u < width && v < height)) return std::nullopt;
    return index(static_cast<int>(u), static_cast<int>(v));
  }
};

/// What speaks against intrinsics: a principal point far from the middle, as in a cropped image, when focal lengths and
/// principal point are swapped, or when width and height are. Empty for a usual camera.
inline std::optional<std::string> doubt_of(const Intrinsics& k) {
  constexpr double kFar = 0.35, kOff = 0.1, kNear = 0.03;  // shares of the width or height
  const auto off = [&](int width, int height) {
    return std::max(std::abs(k.cx - 0.5 * (width - 1)) / width, std::abs(k.cy - 0.5 * (height - 1)) / height);
  };
  const double as_is = off(k.width, k.height);
  const bool transposed = as_is > kOff && off(k.height, k.width) < kNear;
  if (!transposed && !(as_is > kFar)) return std::nullopt;
  const auto whole = [](double pixels) { return std::to_string(std::lround(pixels)); };
  return "the principal point, (" + whole(k.cx) + ", " + whole(k.cy) + "), is far from the middle of the image, " +
         std::to_string(k.width) + " x " + std::to_string(k.height) +
         (transposed ? ", but in that of one of " + std::to_string(k.height) + " x " + std::to_string(k.width) +
                           ": is the image transposed? Arrays have the shape (rows, columns)"
                     : ": is the image cropped, or are fx, fy and cx, cy swapped?");
}

/// Intrinsics of an image whose principal point is in its middle.
/// @param width of the image (pixels)
/// @param height of the image (pixels)
/// @param fov_x full opening angle over the width (rad)
/// @param fov_y full opening angle over the height (rad)
/// @throws ParameterError for sizes below one pixel or angles outside (0, pi)
inline Intrinsics intrinsics_from_fov(int width, int height, double fov_x, double fov_y) {
  check_parameter(width >= 1, "sensor width", "1 or more", width);
  check_parameter(height >= 1, "sensor height", "1 or more", height);
  check_parameter(fov_x > 0 && fov_x < kPi, "horizontal field of view", "above 0 and below pi", fov_x);
  check_parameter(fov_y > 0 && fov_y < kPi, "vertical field of view", "above 0 and below pi", fov_y);
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
