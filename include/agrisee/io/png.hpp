// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Colour images, and PNG files of them.
#pragma once

#include <agrisee/io/palette.hpp>

#include <filesystem>
#include <vector>

namespace agrisee::io {

/// An image, row by row from the top left.
struct Image {
  int width = 0;            ///< pixels
  int height = 0;           ///< pixels
  std::vector<Rgb> pixels;  ///< width * height of them

  /// Pixel x of row y, counted from the upper left.
  const Rgb& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

/// Write an image as PNG, atomically.
/// @throws InputError when the image is empty or its size and pixels disagree  @throws FileError when it cannot be
/// written
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace agrisee::io
