// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/png16.hpp"

#include <agrisee/io/files.hpp>

#include <limits>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb_image.h>

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

/// Test that an image has one channel of 16 bits, and not more pixels than its bytes can encode.
void check_kind(const std::filesystem::path& path, std::string_view bytes) {
  const std::size_t header = kPngSignature.size() + 8;
  const std::uint64_t width = big_endian(bytes, header), height = big_endian(bytes, header + 4);
  const int bits = bytes[header + 8], kind = bytes[header + 9];
  if (kind != 0) fail(path, "is a colour image; depth has one grey channel");
  if (bits != 16) fail(path, "has " + std::to_string(bits) + " bits a pixel; depth needs 16");
  constexpr std::uint64_t kMost = 16384, kBestRatio = 1032;  // of deflate
  if (width < 1 || height < 1 || width > kMost || height > kMost)
    fail(path, "has " + std::to_string(width) + " x " + std::to_string(height) + " pixels; at most " +
                   std::to_string(kMost) + " each way are read");
  if (2 * width * height / kBestRatio > bytes.size()) fail(path, "is damaged: too short for its size");
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.substr(0, kPngSignature.size()) == kPngSignature; }

GreyImage decode_png16(const std::filesystem::path& path, std::string_view bytes) {
  check_chunks(path, bytes);
  check_kind(path, bytes);
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) fail(path, "is larger than 2 GB");
  GreyImage image;
  int channels = 0;
  stbi_us* pixels = stbi_load_16_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                             static_cast<int>(bytes.size()), &image.width, &image.height, &channels, 1);
  if (!pixels) fail(path, std::string("cannot be decoded: ") + stbi_failure_reason());
  image.pixels.assign(pixels, pixels + static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  stbi_image_free(pixels);
  return image;
}

std::string encode_png16(const GreyImage& image) {
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
