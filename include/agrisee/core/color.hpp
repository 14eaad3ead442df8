// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A colour as cameras and screens have it.
#pragma once

#include <array>
#include <cstdint>

namespace agrisee {

/// Red, green and blue, 0..255 each, encoded as sRGB (IEC 61966-2-1).
using Rgb = std::array<std::uint8_t, 3>;

}  // namespace agrisee
