// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// PNG files of gray levels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace agrisee::io {

/// The bytes of a PNG file with 8-bit gray levels.
/// @param width, height size of the image, at least 1  @param levels width * height levels, row by row
std::string gray_png(int width, int height, const std::vector<std::uint8_t>& levels);

}  // namespace agrisee::io
