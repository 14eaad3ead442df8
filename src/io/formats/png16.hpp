// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// PNG images: with one channel of 16 bits, as depth cameras store them, with colors, and with labels.
#pragma once

#include <agrisee/io/color_image.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace agrisee::io {

/// An image with one channel of 16 bits, row by row from the top left.
struct GrayImage {
  int width = 0, height = 0;
  std::vector<std::uint16_t> pixels;
};

/// Whether a file begins like a PNG file.
bool is_png(std::string_view bytes);

/// Decode a PNG image (by stb_image). The checksum of every chunk is tested. @param path for messages
/// @throws FileError for bytes that are no PNG or damaged, a color image, and one of fewer than 16 bits
GrayImage decode_png16(const std::filesystem::path& path, std::string_view bytes);

/// Decode a PNG image with colors of 8 bits, or with a palette. @param path for messages
/// @throws FileError for bytes that are no PNG or damaged, a gray image, and one of 16 bits a channel
ColorImage decode_png_colors(const std::filesystem::path& path, std::string_view bytes);

/// Decode a PNG image with one gray channel of 8 or 16 bits. @param path for messages
/// @throws FileError for bytes that are no PNG or damaged, and a color image
LabelImage decode_png_labels(const std::filesystem::path& path, std::string_view bytes);

/// The bytes of a PNG image.
std::string encode_png16(const GrayImage& image);

}  // namespace agrisee::io
