// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Decoder of the LZF stream format (M. Lehmann, LibLZF), which compressed PCD files use.
#pragma once

#include <cstddef>
#include <cstring>

namespace agrisee::io {

/// The most bytes that one compressed byte can stand for: three make a run of 264.
constexpr std::size_t kLzfMostPerByte = 88;

/// Decode [in, in + in_size) into exactly [out, out + out_size).
///
/// A control byte c < 32 announces c + 1 bytes to be taken as they are; any other a copy of (c >> 5) + 2 bytes (7 in
/// the top bits: the next byte adds to the length) from up to 8192 bytes back (low five bits, then one byte more).
/// @return false when the stream is damaged or does not decode to that many bytes
inline bool lzf_decode(const char* in, std::size_t in_size, char* out, std::size_t out_size) {
  std::size_t i = 0, o = 0;
  const auto byte = [&](std::size_t at) { return static_cast<std::size_t>(static_cast<unsigned char>(in[at])); };
  while (i < in_size) {
    const std::size_t control = byte(i++);
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > in_size - i || length > out_size - o) return false;
      std::memcpy(out + o, in + i, length);
      i += length;
      o += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (i >= in_size) return false;
      length += byte(i++);
    }
    length += 2;
    if (i >= in_size) return false;
    const std::size_t back = ((control & 31) << 8) + byte(i++) + 1;
    if (back > o || length > out_size - o) return false;
    for (const std::size_t end = o + length; o < end; ++o) out[o] = out[o - back];  // the two may overlap
  }
  return o == out_size;
}

}  // namespace agrisee::io
