// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The PLY format (Turk, "The PLY Polygon File Format", 1994), whatever it describes.
#pragma once

#include <agrisee/io/files.hpp>

#include <functional>
#include <string>
#include <vector>

#include "columns.hpp"

namespace agrisee::io {

struct PlyProperty {
  std::string name;
  Scalar type = Scalar::f32;
  bool is_list = false;
  Scalar count_type = Scalar::u8;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_list() const;
  /// Bytes of a record without the contents of its lists.
  std::size_t record_size() const;
  /// Index of a property of one of these names, or -1.
  int find(std::initializer_list<const char*> names) const;
};

/// A PLY file whose header has been read and found to fit the file's size. Binary records of one size are read block by
/// block, all others at once.
class PlyDocument {
 public:
  /// What to take from an element: one sink a scalar property (false = skip), and a call for each record of one list.
  struct Wanted {
    std::vector<Sink> sinks;
    int list = -1;  ///< index of the list property, or -1
    std::function<void(std::size_t record, const std::vector<double>& values)> on_list;
  };

  /// @throws FileError when it cannot be read or is no PLY file
  explicit PlyDocument(const std::filesystem::path& path);

  /// The element of that name, or nullptr.
  const PlyElement* find(const char* name) const;
  /// Read the elements named, once; the others are skipped.
  /// @throws FileError where the file is truncated or not numeric
  void read(const std::vector<std::pair<const PlyElement*, Wanted>>& wanted);

 private:
  void parse_header();
  void check_sizes() const;
  void read_blocks(const PlyElement& element, const Wanted* wanted);
  void read_records(const PlyElement& element, const Wanted* wanted);
  std::size_t next(char* to, std::size_t size);
  void read_text(const PlyElement& element, const Wanted* wanted, class Lines& lines) const;
  [[noreturn]] void fail_truncated(const PlyElement& element, std::size_t record) const;

  std::filesystem::path path_;
  InputFile file_;
  Bytes bytes_;  // the beginning of the file, or all of it
  std::vector<PlyElement> elements_;
  bool ascii_ = false, swapped_ = false;
  std::size_t size_ = 0;       // of the file
  std::size_t body_ = 0;       // offset of the first record, then of what is read next
  std::size_t body_line_ = 0;  // its line
};

}  // namespace agrisee::io
