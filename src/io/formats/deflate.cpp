// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/deflate.hpp"

#include <stdexcept>
#include <zlib.h>

namespace agrisee::io {

std::string deflate(std::string_view bytes) {
  // Of filtered images little but runs repeats; a search for all repetitions takes five times as long.
  z_stream stream{};
  constexpr int kLevel = 6, kWindowBits = 15, kMemory = 9;
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kWindowBits, kMemory, Z_RLE) != Z_OK)
    throw std::runtime_error("zlib: out of memory");
  std::string out(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int code = ::deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (code != Z_STREAM_END) throw std::runtime_error("zlib: the bytes could not be compressed");
  return out;
}

}  // namespace agrisee::io
