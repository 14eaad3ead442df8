// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The pixels of depth images as robots send and record them: their encodings, by the names that ROS has for them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace agrisee::sensor {

/// Bytes of a pixel of a depth image: 2 for `16UC1` and `mono16` (mm), 4 for `32FC1` (m), 0 for other encodings.
inline std::size_t depth_bytes(std::string_view encoding) {
  if (encoding == "16UC1" || encoding == "mono16") return 2;
  return encoding == "32FC1" ? 4 : 0;
}

/// The depth of a pixel (m); 0 = no return, which is also what is not finite, negative or, in millimetres, 65535.
/// @param pixel its bytes, which need not be aligned
/// @param bytes their number, from depth_bytes: 2 or 4
inline float depth_of_pixel(const std::uint8_t* pixel, std::size_t bytes, bool big_endian) {
  std::uint32_t bits = 0;
  for (std::size_t b = 0; b < bytes; ++b) bits = bits << 8 | pixel[big_endian ? b : bytes - 1 - b];
  if (bytes == 2) return bits == 0xFFFF ? 0.0f : 0.001f * static_cast<float>(bits);
  float z = 0.0f;
  std::memcpy(&z, &bits, sizeof z);
  return std::isfinite(z) && z > 0.0f ? z : 0.0f;
}

}  // namespace agrisee::sensor
