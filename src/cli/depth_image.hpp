// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A single depth image as the input of `agrisee process`, with the color image and the detections that belong to it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "recorded.hpp"

namespace agrisee::cli {

/// What the options say of the image. Paths are empty if not given.
struct DepthImageOptions {
  std::string depth, color, masks, boxes;  ///< files
  std::vector<double> intrinsics;          ///< fx, fy, cx, cy (pixels)
  std::vector<double> distortion;          ///< k1, k2, p1, p2, k3, k4, k5, k6; empty: none
  double depth_scale = 0.0;                ///< m per unit; 0: the default
};

/// Add --depth and the options that belong to it. `options` has to outlive the command.
void add_depth_image_options(CLI::App& command, DepthImageOptions& options);

/// Find the fruit of a single depth image; the frame of the result is the camera's optical frame.
/// @param threads as of --threads
/// @throws FileError for what the files hold, UsageError for what the options say
Processed process_depth_image(const DepthImageOptions& options, const Parameters& parameters, int threads);

}  // namespace agrisee::cli
