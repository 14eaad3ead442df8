// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/png.hpp>

#include <algorithm>

#include "io/formats/png_file.hpp"
#include "io/picture/gray_png.hpp"

namespace agrisee::io {
namespace {

constexpr char kSub = 1;  // the filter: the difference to the pixel on the left; of smooth surfaces it is small

/// The rows of an image of 8 bits a channel, filtered.
std::string filtered(const std::uint8_t* bytes, int width, int height, std::size_t channels) {
  const std::size_t stride = channels * static_cast<std::size_t>(width);
  std::string rows((stride + 1) * static_cast<std::size_t>(height), kSub);
  char* to = rows.data() + 1;
  for (int y = 0; y < height; ++y, bytes += stride, to += stride + 1) {
    for (std::size_t x = 0; x < std::min(channels, stride); ++x) to[x] = static_cast<char>(bytes[x]);
    for (std::size_t x = channels; x < stride; ++x) to[x] = static_cast<char>(bytes[x] - bytes[x - channels]);
  }
  return rows;
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  check_input(image.width > 0 && image.height > 0 &&
                  image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
              "write_png: the image is empty or its size and pixels disagree");
  static_assert(sizeof(Rgb) == 3, "pixels are packed");
  const std::string rows = filtered(image.pixels.front().data(), image.width, image.height, 3);
  write_file(path, png_file(image.width, image.height, 8, PngKind::rgb, rows));
}

std::string gray_png(int width, int height, const std::vector<std::uint8_t>& levels) {
  return png_file(width, height, 8, PngKind::gray, filtered(levels.data(), width, height, 1));
}

}  // namespace agrisee::io
