// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/png16.hpp"

#include <agrisee/io/files.hpp>

#include <limits>
#include <type_traits>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb_image.h>

#include "io/formats/crc32.hpp"
#include "io/formats/png_file.hpp"

namespace agrisee::io {
namespace {

constexpr std::size_t kHeaderChunk = 13;  // bytes of IHDR

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// Test that a PNG file is whole: all of its chunks, up to the last, with their checksums. (stb_image tests neither.)
void check_chunks(const std::filesystem::path& path, std::string_view bytes) {
  if (!is_png(bytes)) fail(path, "is not a PNG file");
  for (std::size_t at = kPngSignature.size();;) {
    if (bytes.size() - at < 12) fail(path, "is cut off");
    const std::size_t length = big_endian(bytes, at);
    if (bytes.size() - at - 12 < length) fail(path, "is cut off");
    const std::string_view type = bytes.substr(at + 4, 4);
    if (at == kPngSignature.size() && (type != "IHDR" || length != kHeaderChunk))
      fail(path, "is damaged: no PNG header");
#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION  // a fuzzer would never get past it
    if (crc32(bytes.substr(at + 4, 4 + length)) != big_endian(bytes, at + 8 + length))
      fail(path, "is damaged: a checksum is wrong");
#endif
    if (type == "IEND") return;
    at += 12 + length;
  }
}

/// What the header of an image says.
struct PngHeader {
  std::uint64_t width, height;
  int bits;  // of a channel
  int kind;  // 0 gray, 2 color, 3 palette, 4 gray with opacity, 6 color with opacity
};

/// Test that a file is whole and small enough, and not of more pixels than its bytes can encode.
PngHeader checked_header(const std::filesystem::path& path, std::string_view bytes) {
  check_chunks(path, bytes);
  const std::size_t at = kPngSignature.size() + 8;
  const PngHeader header{big_endian(bytes, at), big_endian(bytes, at + 4), bytes[at + 8], bytes[at + 9]};
  constexpr std::uint64_t kMost = 16384;
  if (header.width < 1 || header.height < 1 || header.width > kMost || header.height > kMost)
    fail(path, "has " + std::to_string(header.width) + " x " + std::to_string(header.height) + " pixels; at most " +
                   std::to_string(kMost) + " each way are read");
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) fail(path, "is larger than 2 GB");
  return header;
}

/// Test that an image is not of more pixels than its bytes can encode. @param bits a pixel
void check_size(const std::filesystem::path& path, const PngHeader& header, int bits, std::string_view bytes) {
  constexpr std::uint64_t kBestRatio = 1032;  // of deflate
  if (static_cast<std::uint64_t>(bits) * header.width * header.height / 8 / kBestRatio > bytes.size())
    fail(path, "is damaged: too short for its size");
}

/// Decode by stb_image. @param channels how many to make  @param load its function for 8 or for 16 bits
template <typename Load>
auto decoded(const std::filesystem::path& path, std::string_view bytes, int channels, Load&& load, int& width,
             int& height) {
  int in_file = 0;
  auto* pixels = load(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()), &width, &height,
                      &in_file, channels);
  if (!pixels) fail(path, std::string("cannot be decoded: ") + stbi_failure_reason());
  const std::size_t size =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels);
  std::vector<std::remove_pointer_t<decltype(pixels)>> out(pixels, pixels + size);
  stbi_image_free(pixels);
  return out;
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.substr(0, kPngSignature.size()) == kPngSignature; }

GrayImage decode_png16(const std::filesystem::path& path, std::string_view bytes) {
  const PngHeader header = checked_header(path, bytes);
  if (header.kind != 0) fail(path, "is a color image; depth has one gray channel");
  if (header.bits != 16) fail(path, "has " + std::to_string(header.bits) + " bits a pixel; depth needs 16");
  check_size(path, header, 16, bytes);
  GrayImage image;
  image.pixels = decoded(path, bytes, 1, stbi_load_16_from_memory, image.width, image.height);
  return image;
}

ColorImage decode_png_colors(const std::filesystem::path& path, std::string_view bytes) {
  const PngHeader header = checked_header(path, bytes);
  if (header.kind == 0 || header.kind == 4)
    fail(path, "is a gray image of " + std::to_string(header.bits) + " bits; a color image has three channels");
  if (header.bits == 16) fail(path, "has 16 bits a channel; colors need 8");
  check_size(path, header, header.kind == 3 ? header.bits : 24, bytes);
  ColorImage image;
  const auto values = decoded(path, bytes, 3, stbi_load_from_memory, image.width, image.height);
  image.pixels.resize(values.size() / 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return image;
}

LabelImage decode_png_labels(const std::filesystem::path& path, std::string_view bytes) {
  const PngHeader header = checked_header(path, bytes);
  if (header.kind != 0)
    fail(path, "has colors or opacity; a label image has one gray channel, whose values are numbers of instances");
  if (header.bits != 8 && header.bits != 16)
    fail(path, "has " + std::to_string(header.bits) + " bits a pixel; a label image needs 8 or 16");
  check_size(path, header, header.bits, bytes);
  LabelImage image;
  if (header.bits == 16) {
    image.labels = decoded(path, bytes, 1, stbi_load_16_from_memory, image.width, image.height);
  } else {
    const auto values = decoded(path, bytes, 1, stbi_load_from_memory, image.width, image.height);
    image.labels.assign(values.begin(), values.end());
  }
  return image;
}

std::string encode_png16(const GrayImage& image) {
  const auto width = static_cast<std::size_t>(image.width);
  // Each row: the number of its filter (2, "up"), then the differences to the row above, byte by byte.
  std::string rows;
  rows.reserve((2 * width + 1) * static_cast<std::size_t>(image.height));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (i % width == 0) rows += '\2';
    const unsigned value = image.pixels[i], above = i < width ? 0u : image.pixels[i - width];
    rows += static_cast<char>((value >> 8) - (above >> 8));
    rows += static_cast<char>((value & 255u) - (above & 255u));
  }
  return png_file(image.width, image.height, 16, PngKind::gray, rows);
}

}  // namespace agrisee::io
