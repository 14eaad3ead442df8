// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/crc32.hpp"

#include <zlib.h>

namespace agrisee::io {

std::uint32_t crc32(std::string_view bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<z_size_t>(bytes.size())));
}

}  // namespace agrisee::io
