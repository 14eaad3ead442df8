// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What all PNG files have in common (PNG specification, sections 5 and 11): the signature, chunks with checksums, and
/// how to write one.
#pragma once

#include <string>
#include <string_view>

namespace agrisee::io {

/// The first bytes of every PNG file.
constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);

/// The kinds of images that are written, by the number that a PNG file has for them.
enum class PngKind : char { gray = 0, rgb = 2 };

/// The bytes of a PNG file.
/// @param width, height of the image (pixels), at least 1
/// @param bits of a channel: 8 or 16
/// @param kind which channels a pixel has
/// @param rows for each row the number of its filter (section 9), then its filtered bytes
std::string png_file(int width, int height, int bits, PngKind kind, std::string_view rows);

}  // namespace agrisee::io
