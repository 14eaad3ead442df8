// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a `sensor_msgs/CameraInfo` of ROS states of a camera, and the camera that it describes: by one rule for
/// messages and for recordings of them.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/sensor/intrinsics.hpp>
#include <agrisee/sensor/rectify.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace agrisee::sensor {

/// The numbers of a CameraInfo, named as in ROS 2.
struct CameraInfo {
  std::uint32_t width = 0;         ///< columns of the image (pixels)
  std::uint32_t height = 0;        ///< rows of the image (pixels)
  std::string distortion_model;    ///< that of `d`
  std::vector<double> d;           ///< coefficients of the distortion
  std::array<double, 9> k{};       ///< camera matrix of the images as taken, row by row
  std::array<double, 12> p{};      ///< projection matrix of rectified images, row by row
  std::uint32_t binning_x = 0;     ///< columns that one pixel joins; 0 and 1: none
  std::uint32_t binning_y = 0;     ///< rows that one pixel joins; 0 and 1: none
  std::uint32_t roi_x_offset = 0;  ///< left border of the region of interest (pixels)
  std::uint32_t roi_y_offset = 0;  ///< upper border of the region of interest (pixels)
  std::uint32_t roi_width = 0;     ///< its width (pixels); 0: that of the image
  std::uint32_t roi_height = 0;    ///< its height (pixels); 0: that of the image
};

namespace detail {

/// Throw InputError("CameraInfo: <message>") unless `ok`.
inline void check_camera_info(bool ok, const std::string& message) {
  if (!ok) throw InputError("CameraInfo: " + message);
}

/// Whether all numbers are 0.
template <typename List>
bool all_zero(const List& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return x == 0.0; });
}

}  // namespace detail

/// The intrinsics of the images: K, or, of `rectified` images, P. Where a driver that does not rectify leaves P empty,
/// K stands for it: without distortion both are the same.
/// @throws InputError for binning or a region of interest, for a size or a matrix that no pinhole has, and for images
///   without P, though rectified, of a lens that distorts
inline Intrinsics intrinsics_of(const CameraInfo& info, bool rectified = false) {
  constexpr std::uint32_t kMost = 16384;
  const auto check = detail::check_camera_info;
  check(info.width >= 1 && info.height >= 1 && info.width <= kMost && info.height <= kMost,
        std::to_string(info.width) + " x " + std::to_string(info.height) + " pixels");
  check(info.binning_x <= 1 && info.binning_y <= 1, "binning is not supported");
  check(info.roi_x_offset == 0 && info.roi_y_offset == 0 && (info.roi_width == 0 || info.roi_width == info.width) &&
            (info.roi_height == 0 || info.roi_height == info.height),
        "a region of interest is not supported");
  const bool projected = rectified && !detail::all_zero(info.p);
  check(projected || !rectified || detail::all_zero(info.d), "the images are rectified, but P is empty");
  Intrinsics k;
  k.width = static_cast<int>(info.width);
  k.height = static_cast<int>(info.height);
  k.fx = projected ? info.p[0] : info.k[0];
  k.cx = projected ? info.p[2] : info.k[2];
  k.fy = projected ? info.p[5] : info.k[4];
  k.cy = projected ? info.p[6] : info.k[5];
  check(std::isfinite(k.fx) && std::isfinite(k.fy) && k.fx > 0.0 && k.fy > 0.0,
        "has no focal length: " + number_text(k.fx, 4) + " and " + number_text(k.fy, 4) +
            (projected ? " (p[0] and p[5])" : " (k[0] and k[4])") + ": is the camera calibrated?");
  check(std::isfinite(k.cx) && std::isfinite(k.cy), "the principal point is not finite");
  return k;
}

/// The distortion of images that are not rectified, by the model `plumb_bob` or `rational_polynomial`; none if all
/// coefficients are 0. @throws InputError for other models, such as those of fisheye lenses, and as distortion_from
inline Distortion distortion_of(const CameraInfo& info) {
  if (detail::all_zero(info.d)) return {};
  const std::string& model = info.distortion_model;
  if (!model.empty() && model != "plumb_bob" && model != "rational_polynomial") {
    std::string shown = model.substr(0, 40);
    std::replace_if(
        shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    throw InputError("CameraInfo: the lens distorts by the model '" + shown +
                     "', which is not supported: use images that the driver has rectified");
  }
  return distortion_from(info.d);
}

}  // namespace agrisee::sensor
