// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A color image, and how to write it as a PNG file.
#pragma once

#include <agrisee/io/palette.hpp>

#include <filesystem>
#include <vector>

namespace agrisee::io {

/// A color image; pixels are stored row by row from the top left.
struct Image {
  int width = 0;            ///< pixels per row
  int height = 0;           ///< rows
  std::vector<Rgb> pixels;  ///< width * height colors

  /// Pixel x of row y, both counted from the top left.
  const Rgb& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

/// Write an image as a PNG file, atomically.
/// @throws InputError when the image is empty, or `pixels` does not have width * height elements
/// @throws FileError when the file cannot be written
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace agrisee::io
