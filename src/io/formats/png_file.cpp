// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/png_file.hpp"

#include <cstdint>

#include "io/formats/crc32.hpp"
#include "io/formats/deflate.hpp"

namespace agrisee::io {
namespace {

void put_big_endian(std::string& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 255u);
}

void put_chunk(std::string& out, const char* type, std::string_view data) {
  put_big_endian(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = out.size();
  out += type;
  out += data;
  put_big_endian(out, crc32(std::string_view(out).substr(begin)));
}

}  // namespace

std::string png_file(int width, int height, int bits, PngKind kind, std::string_view rows) {
  std::string header;
  put_big_endian(header, static_cast<std::uint32_t>(width));
  put_big_endian(header, static_cast<std::uint32_t>(height));
  header += {static_cast<char>(bits), static_cast<char>(kind), '\0', '\0', '\0'};  // deflate, filters, not interlaced
  std::string out(kPngSignature);
  put_chunk(out, "IHDR", header);
  put_chunk(out, "IDAT", deflate(rows));
  put_chunk(out, "IEND", "");
  return out;
}

}  // namespace agrisee::io
