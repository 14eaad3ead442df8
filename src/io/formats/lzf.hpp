// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Decodes the LZF stream format (M. Lehmann, LibLZF), which compressed PCD files use.
#pragma once

#include <cstddef>
#include <cstring>

namespace agrisee::io {

/// The largest ratio of decoded to compressed bytes: three compressed bytes can stand for 264.
constexpr std::size_t kLzfMostPerByte = 88;

/// Decode the `in_size` bytes at `in` into exactly `out_size` bytes at `out`.
///
/// A control byte c < 32 is followed by c + 1 literal bytes. Any other control byte copies (c >> 5) + 2 bytes that were
/// decoded before; if c >> 5 is 7, the next byte is added to this length. The distance back to them, at most 8192
/// bytes, is 1 plus a number of 13 bits: the low five bits of c, then the byte that follows.
/// @return false when the stream is damaged or does not decode to `out_size` bytes
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
