// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Columns of numbers of any type, decoded from binary records or lines of text into arrays of float or int.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "agrisee::io needs a little-endian machine"
#endif

namespace agrisee::io {

enum class Scalar : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// Bytes of a number.
constexpr std::size_t size_of(Scalar type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

/// Where the numbers of a column go: at most one of the two arrays; neither = skipped. Row r goes to [r * step].
struct Sink {
  float* floats = nullptr;
  int* ints = nullptr;
  std::size_t step = 1;

  explicit operator bool() const { return floats || ints; }
  /// The same from row `first` on.
  Sink from(std::size_t first) const {
    return {floats ? floats + first * step : nullptr, ints ? ints + first * step : nullptr, step};
  }
  /// False when the number is no int but has to be one.
  bool store(std::size_t row, double value) const;
};

/// A column of binary numbers.
struct Column {
  const char* data;    ///< the first number
  std::size_t stride;  ///< bytes from one to the next
  Scalar type;
  bool swapped;  ///< big-endian
  Sink sink;
};

/// The number at `data`.
double read_scalar(const char* data, Scalar type, bool swapped);

/// Decode `rows` numbers of each column.
/// @return the first row with a number that is no int but has to be one, if any
std::optional<std::size_t> decode(const std::vector<Column>& columns, std::size_t rows);

/// Append the bytes of a number to a record.
template <typename T>
void put(char*& at, T value) {
  std::memcpy(at, &value, sizeof(T));
  at += sizeof(T);
}

}  // namespace agrisee::io
