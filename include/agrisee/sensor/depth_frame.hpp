// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A depth image, with optional colors and detections.
#pragma once

#include <agrisee/core/median.hpp>
#include <agrisee/core/types.hpp>
#include <agrisee/sensor/detection.hpp>
#include <agrisee/sensor/intrinsics.hpp>

#include <optional>
#include <vector>

namespace agrisee::sensor {

/// A depth image in the optical frame (z forward, x right, y down). Its other channels are optional and registered to
/// it: pixel by pixel the same rays.
struct DepthFrame {
  Intrinsics intrinsics;                      ///< of the image
  std::vector<float> depth;                   ///< z (m) of each pixel, row by row; 0, negative or not finite: no return
  std::vector<Rgb> color = {};                ///< of each pixel, or empty
  std::vector<std::uint16_t> instances = {};  ///< the detection whose mask contains each pixel, 0 = none; or empty
  std::vector<Detection> detections = {};  ///< one per instance; an instance that is not listed is a fruit with score 1
  bool detected = false;                   ///< a detector has looked at this frame, even if it found nothing

  /// Depth z (m) of the pixel in column u and row v.
  float at(int u, int v) const { return depth[intrinsics.index(u, v)]; }
  /// Whether a depth (m) is that of a return.
  static bool valid(float z) { return z > 0.0f && std::isfinite(z); }
  /// The point (m, optical frame) of a pixel; meaningful where valid(at(u, v)).
  Eigen::Vector3f point(int u, int v) const { return (intrinsics.ray(u, v) * double(at(u, v))).cast<float>(); }
};

/// @throws InputError if the depth image does not have the size in its intrinsics, or these are not usable
inline void check(const DepthFrame& frame) {
  const Intrinsics& k = frame.intrinsics;
  check_input(k.width > 0 && k.height > 0 && std::isfinite(k.fx) && std::isfinite(k.fy) && k.fx > 0 && k.fy > 0 &&
                  std::isfinite(k.cx) && std::isfinite(k.cy),
              "depth frame: unusable intrinsics");
  check_input(frame.depth.size() == k.size(), "depth frame: the image size differs from its intrinsics");
  check_input(frame.color.empty() || frame.color.size() == k.size(), "depth frame: not one color a pixel");
  check_input(frame.instances.empty() || frame.instances.size() == k.size(), "depth frame: not one instance a pixel");
}

/// The median (m) of the depths that are returns, of some 2000 pixels; none without any.
inline std::optional<double> median_depth(const DepthFrame& frame) {
  constexpr std::size_t kSamples = 2000;
  const std::size_t step = frame.depth.size() / kSamples + 1;
  std::vector<float> depths;
  for (std::size_t i = 0; i < frame.depth.size(); i += step)
    if (DepthFrame::valid(frame.depth[i])) depths.push_back(frame.depth[i]);
  if (depths.empty()) return std::nullopt;
  return double(median(depths));
}

/// Check that a depth image can be in metres: one with a median depth above 50 m or below 1 mm cannot. A frame without
/// returns passes.
/// @throws InputError that names the median depth and the likely cause
inline void check_depth_unit(const DepthFrame& frame) {
  const std::optional<double> depth = median_depth(frame);
  if (!depth) return;
  const auto refuse = [&](const char* cause) {
    throw InputError("depth frame: its median depth is " + metres(*depth) + ": " + cause);
  };
  if (*depth > 50.0) refuse("is it in millimetres, or in another unit of the camera? Depths have to be in metres");
  if (*depth < 0.001) refuse("were depths in metres multiplied by the camera's depth unit once more?");
}

}  // namespace agrisee::sensor
