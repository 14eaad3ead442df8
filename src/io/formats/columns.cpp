// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace agrisee::io {
namespace {

/// The number at `data`, of either byte order.
template <typename T, bool Swapped>
T load(const char* data) {
  char bytes[sizeof(T)];
  if constexpr (Swapped)
    std::reverse_copy(data, data + sizeof(T), bytes);
  else
    std::memcpy(bytes, data, sizeof(T));
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// Convert to int. Integers keep their low 32 bits, so that an unsigned "none" (all bits set) becomes -1.
/// @return false for fractions, NaN, and numbers of more than 32 bits
template <typename T>
bool to_int(T value, int& out) {
  if constexpr (std::is_floating_point_v<T>) {
    if (!(value >= T(-2147483648.0) && value < T(2147483648.0)) || value != std::floor(value)) return false;
    out = static_cast<int>(value);
  } else {
    if constexpr (sizeof(T) == 8) {
      if (static_cast<std::int64_t>(value) > std::numeric_limits<std::uint32_t>::max() ||
          static_cast<std::int64_t>(value) < std::numeric_limits<std::int32_t>::min())
        return false;
    }
    out = static_cast<int>(static_cast<std::uint32_t>(value));
  }
  return true;
}

/// Call f with a zero of that type.
template <typename F>
decltype(auto) with_type(Scalar type, F&& f) {
  switch (type) {
    case Scalar::i8:
      return f(std::int8_t{});
    case Scalar::u8:
      return f(std::uint8_t{});
    case Scalar::i16:
      return f(std::int16_t{});
    case Scalar::u16:
      return f(std::uint16_t{});
    case Scalar::i32:
      return f(std::int32_t{});
    case Scalar::u32:
      return f(std::uint32_t{});
    case Scalar::i64:
      return f(std::int64_t{});
    case Scalar::u64:
      return f(std::uint64_t{});
    case Scalar::f32:
      return f(float{});
    case Scalar::f64:
      break;
  }
  return f(double{});
}

/// The 32 bits of a number: of a float as they are, of an integer its lowest. PCL packs colors so.
template <typename T>
std::uint32_t bits_of(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    const auto single = static_cast<float>(value);
    std::uint32_t bits;
    std::memcpy(&bits, &single, sizeof bits);
    return bits;
  } else {
    return static_cast<std::uint32_t>(value);
  }
}

/// Decode the rows [begin, end) of a column. @return the first row whose number is not an int but must be, or end
template <typename T, bool Swapped>
std::size_t decode_rows(const Column& c, std::size_t begin, std::size_t end) {
  const char* data = c.data + begin * c.stride;
  if (c.sink.floats) {
    float* out = c.sink.floats + begin * c.sink.step;
    for (std::size_t r = begin; r < end; ++r, data += c.stride, out += c.sink.step)
      *out = static_cast<float>(load<T, Swapped>(data));
  } else if (c.sink.ints) {
    int* out = c.sink.ints + begin * c.sink.step;
    for (std::size_t r = begin; r < end; ++r, data += c.stride, out += c.sink.step)
      if (!to_int(load<T, Swapped>(data), *out)) return r;
  } else if (c.sink.bits) {
    std::uint32_t* out = c.sink.bits + begin * c.sink.step;
    for (std::size_t r = begin; r < end; ++r, data += c.stride, out += c.sink.step)
      *out = bits_of(load<T, Swapped>(data));
  }
  return end;
}

}  // namespace

bool Sink::store(std::size_t row, double value) const {
  if (floats) floats[row * step] = static_cast<float>(value);
  if (bits) {
    if (!from_float && !(value >= -2147483648.0 && value <= 4294967295.0)) return false;
    bits[row * step] = from_float ? bits_of(value) : bits_of(static_cast<std::int64_t>(value));
  }
  if (!ints) return true;
  if (value >= 2147483648.0 && value <= 4294967295.0) value -= 4294967296.0;  // low 32 bits, as in to_int
  return to_int(value, ints[row * step]);
}

double read_scalar(const char* data, Scalar type, bool swapped) {
  return with_type(type, [&](auto zero) {
    using T = decltype(zero);
    return static_cast<double>(swapped ? load<T, true>(data) : load<T, false>(data));
  });
}

std::optional<std::size_t> decode(const std::vector<Column>& columns, std::size_t rows) {
  constexpr std::size_t kBlock =
      2048;  // rows; a block stays in the cache while its columns are decoded one after the other
  std::optional<std::size_t> refused;
  for (std::size_t begin = 0; begin < rows && !refused; begin += kBlock) {
    const std::size_t end = std::min(rows, begin + kBlock);
    for (const Column& c : columns) {
      const std::size_t stop = with_type(c.type, [&](auto zero) {
        using T = decltype(zero);
        return c.swapped ? decode_rows<T, true>(c, begin, end) : decode_rows<T, false>(c, begin, end);
      });
      if (stop != end && (!refused || stop < *refused)) refused = stop;
    }
  }
  return refused;
}

}  // namespace agrisee::io
