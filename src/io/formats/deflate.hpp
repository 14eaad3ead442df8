// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Compresses bytes by zlib (RFC 1950), for PNG files.
#pragma once

#include <string>
#include <string_view>

namespace agrisee::io {

/// The bytes, at most 4 GB, as a zlib stream. Only runs of one byte are replaced, the rest is Huffman coded. O(n).
std::string deflate(std::string_view bytes);

}  // namespace agrisee::io
