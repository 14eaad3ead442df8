// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Compresses bytes as zlib does (RFC 1950, RFC 1951), for PNG files. Only runs of one byte are replaced; for the rest
/// a Huffman code is made anew every few hundred kilobytes. Of filtered images little else repeats, and this takes a
/// fifth of the time of a search for all repetitions.
#pragma once

#include <string>
#include <string_view>

namespace agrisee::io {

/// The bytes as a zlib stream. The same bytes give the same stream. O(n).
std::string deflate(std::string_view bytes);

}  // namespace agrisee::io
