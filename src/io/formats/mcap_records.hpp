// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The records of MCAP.
#pragma once

#include <cstdint>
#include <string_view>

namespace agrisee::io::mcap {

/// The first and the last bytes of a file.
constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

/// Opcodes.
enum : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kMetadata = 12,
  kMetadataIndex = 13,
  kSummaryOffset = 14,
  kDataEnd = 15
};

}  // namespace agrisee::io::mcap
