// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads the images that come with a depth image: colors, and the masks of a detector. PNG.
#pragma once

#include <agrisee/core/types.hpp>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace agrisee::io {

/// A color image, row by row from the top left.
struct ColorImage {
  int width = 0;            ///< pixels per row
  int height = 0;           ///< rows
  std::vector<Rgb> pixels;  ///< one per pixel
};

/// A label image, row by row from the top left.
struct LabelImage {
  int width = 0;                      ///< pixels per row
  int height = 0;                     ///< rows
  std::vector<std::uint16_t> labels;  ///< the instance of each pixel, 0 = none
};

/// Read a color image: PNG with three channels, or four, of 8 bits, or with a palette. Opacity is ignored.
/// @throws FileError when the file cannot be read, is no PNG, is damaged, is gray, or has 16 bits a channel
ColorImage read_color_image(const std::filesystem::path& path);

/// Read a label image: PNG with one gray channel of 8 or 16 bits whose values are the numbers of instances.
/// @throws FileError when the file cannot be read, is no PNG, is damaged, or has colors
LabelImage read_label_image(const std::filesystem::path& path);

}  // namespace agrisee::io
