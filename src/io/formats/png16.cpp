// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/png16.hpp"

#include <agrisee/io/files.hpp>

#include <array>
#include <limits>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace agrisee::io {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t kHeaderChunk = 13;  // bytes of IHDR

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

void put_big_endian(std::string& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 255u);
}

/// The checksum of PNG chunks (CRC-32; PNG specification, annex D).
std::uint32_t crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> out{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      out[n] = n;
      for (int k = 0; k < 8; ++k) out[n] = out[n] & 1u ? 0xEDB88320u ^ out[n] >> 1 : out[n] >> 1;
    }
    return out;
  }();
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 255u] ^ crc >> 8;
  return ~crc;
}

/// Test that a PNG file is whole: all of its chunks, up to the last, with their checksums. (stb_image tests neither.)
void check_chunks(const std::filesystem::path& path, std::string_view bytes) {
  if (!is_png(bytes)) fail(path, "is not a PNG file");
  for (std::size_t at = kSignature.size();;) {
    if (bytes.size() - at < 12) fail(path, "is cut off");
    const std::size_t length = big_endian(bytes, at);
    if (bytes.size() - at - 12 < length) fail(path, "is cut off");
    const std::string_view type = bytes.substr(at + 4, 4);
    if (at == kSignature.size() && (type != "IHDR" || length != kHeaderChunk)) fail(path, "is damaged: no PNG header");
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
  const std::size_t header = kSignature.size() + 8;
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

std::string chunk(const char* type, std::string_view data) {
  std::string body = type;
  body += data;
  std::string out;
  put_big_endian(out, static_cast<std::uint32_t>(data.size()));
  out += body;
  put_big_endian(out, crc32(body));
  return out;
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.substr(0, kSignature.size()) == kSignature; }

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
  std::string header;
  put_big_endian(header, static_cast<std::uint32_t>(image.width));
  put_big_endian(header, static_cast<std::uint32_t>(image.height));
  header += {'\20', '\0', '\0', '\0', '\0'};  // 16 bits, grey, deflate, filters by row, not interlaced
  int size = 0;
  unsigned char* packed =
      stbi_zlib_compress(reinterpret_cast<unsigned char*>(rows.data()), static_cast<int>(rows.size()), &size, 5);
  if (!packed) throw std::bad_alloc();
  const std::string data(reinterpret_cast<const char*>(packed), static_cast<std::size_t>(size));
  STBIW_FREE(packed);
  return std::string(kSignature) + chunk("IHDR", header) + chunk("IDAT", data) + chunk("IEND", "");
}

}  // namespace agrisee::io
