// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads arrays of numbers from NPY files, the format of numpy.save (NumPy Enhancement Proposal 1), and writes them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/columns.hpp"

namespace agrisee::io {

/// An array in an NPY file. It refers to the bytes that it was read from.
struct NpyArray {
  Scalar type = Scalar::f32;       ///< of the numbers
  bool swapped = false;            ///< big-endian
  bool fortran = false;            ///< the first index varies fastest, not the last
  std::vector<std::size_t> shape;  ///< length of each dimension
  const char* data = nullptr;      ///< the first number
  /// Number of numbers; the file holds as many.
  std::size_t size() const {
    std::size_t n = 1;
    for (const std::size_t length : shape) n *= length;
    return n;
  }
  /// The shape as Python prints it: "(480, 640)".
  std::string shape_text() const;
};

/// Whether a file begins like an NPY file.
bool is_npy(std::string_view bytes);

/// The array in the bytes of an NPY file. @param path for messages
/// @throws FileError for another format, a type that is no integer of 1 to 8 bytes and no float of 4 or 8 (such as a
/// structured type), or fewer numbers than the shape says
NpyArray parse_npy(const std::filesystem::path& path, std::string_view bytes);

/// The bytes of an NPY file with a matrix of floats. @param values row by row, rows * columns of them
std::string npy_bytes(const std::vector<float>& values, std::size_t rows, std::size_t columns);

}  // namespace agrisee::io
