// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The 8-bit sRGB color of a pixel or a point.
#pragma once

#include <array>
#include <cstdint>

namespace agrisee {

/// Red, green and blue, 0..255 each, encoded as sRGB (IEC 61966-2-1).
using Rgb = std::array<std::uint8_t, 3>;

}  // namespace agrisee
