// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The masks and boxes of one view, pixel by pixel.
#pragma once

#include <agrisee/fuse/masks.hpp>

#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace agrisee::fuse {

/// A view with its masks at hand.
struct MaskImage {
  std::shared_ptr<const sensor::DepthFrame> frame;
  Pose world_T_optical = Pose::Identity();
  std::vector<std::uint16_t> instances;              ///< one per pixel, see instances_of
  std::map<std::uint16_t, sensor::Detection> found;  ///< by instance; one that is not listed is a fruit with score 1
  std::map<std::uint16_t, std::vector<std::uint32_t>> pixels;  ///< of each instance, ascending
  std::set<std::uint16_t> boxed;                               ///< instances that have a box and no mask

  /// The distance (m) from the sensor to what a pixel shows; 0 without a return.
  double distance(std::size_t pixel) const;
  /// The direction (unit, world) of the sight line through a place of the image (pixels).
  Eigen::Vector3d direction(double u, double v) const;
};

/// @throws InputError as instances_of
MaskImage mask_image(const DetectedView& view);

}  // namespace agrisee::fuse
