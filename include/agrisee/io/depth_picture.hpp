// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A small picture of a depth image, for the page of a scan.
#pragma once

#include <agrisee/sensor/depth_frame.hpp>

#include <string>

namespace agrisee::io {

/// A small picture of a depth image: a PNG file of 8-bit gray levels. Level 0 is no return. Levels 1 to 255 are linear
/// in 1/z, from `farthest` to `nearest`, so that near surfaces are resolved finely even if the background is far:
/// between 0.3 m and 3 m, a step is 3 mm at 0.5 m. The nearest and the farthest half percent of the pixels get the
/// levels of the range's ends, so that a few wrong returns do not widen it.
struct DepthPicture {
  int width = 0;          ///< pixels per row
  int height = 0;         ///< rows
  double nearest = 0.0;   ///< z (m) of level 255; 0 without any return
  double farthest = 0.0;  ///< z (m) of level 1; 0 without any return
  std::string png;        ///< the bytes of the file
};

/// The picture of a depth image. Each of its pixels shows the nearest return of a square block of pixels, so that thin
/// stems stay visible. The blocks are the smallest with which no side is longer than `longest_side`.
/// @param frame the depth image
/// @param longest_side limit of width and height (pixels), at least 1
/// @throws InputError for an invalid frame  @throws ParameterError for a `longest_side` below 1
DepthPicture depth_picture(const sensor::DepthFrame& frame, int longest_side = 256);

}  // namespace agrisee::io
