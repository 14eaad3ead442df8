// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Decodes columns of numbers, of any type, from binary records or lines of text into arrays of float or int.
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

/// Type of a number in a file: signed or unsigned integer or floating point, and its size in bits.
enum class Scalar : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// Size of a number of that type (bytes).
constexpr std::size_t size_of(Scalar type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

/// Where the numbers of a column are stored: in at most one of the arrays, row r at index r * step. A column with no
/// array is skipped.
struct Sink {
  float* floats = nullptr;
  int* ints = nullptr;
  std::size_t step = 1;
  std::uint32_t* bits =
      nullptr;              ///< receives the 32 bits of a number: of a float as they are, of an integer its lowest
  bool from_float = false;  ///< whether numbers for `bits` that were read as text are floats

  /// Whether the column is stored at all.
  explicit operator bool() const { return floats || ints || bits; }
  /// The sink of the rows from `first` on.
  Sink from(std::size_t first) const {
    return {floats ? floats + first * step : nullptr, ints ? ints + first * step : nullptr, step,
            bits ? bits + first * step : nullptr, from_float};
  }
  /// Store a number. @return false if the array is of int and the number is not an integer of 32 bits
  bool store(std::size_t row, double value) const;
};

/// A column of binary numbers, and where they are stored.
struct Column {
  const char* data;    ///< the first number
  std::size_t stride;  ///< bytes from one number to the next
  Scalar type;
  bool swapped;  ///< big-endian
  Sink sink;
};

/// The number of type `type` at `data`; `swapped` if it is big-endian.
double read_scalar(const char* data, Scalar type, bool swapped);

/// Decode `rows` numbers of each column.
/// @return the first row in which Sink::store would fail, if any
std::optional<std::size_t> decode(const std::vector<Column>& columns, std::size_t rows);

/// Copy the bytes of a number to `at`, and move `at` behind them.
template <typename T>
void put(char*& at, T value) {
  std::memcpy(at, &value, sizeof(T));
  at += sizeof(T);
}

}  // namespace agrisee::io
