// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The checksum of PNG and MCAP files.
#pragma once

#include <cstdint>
#include <string_view>

namespace agrisee::io {

/// CRC-32 (PNG specification, annex D).
/// @param before that of the bytes before these
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

}  // namespace agrisee::io
