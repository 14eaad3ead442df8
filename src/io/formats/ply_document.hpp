// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads PLY files (Turk, "The PLY Polygon File Format", 1994) with any elements and properties.
#pragma once

#include <agrisee/io/files.hpp>

#include <functional>
#include <string>
#include <vector>

#include "io/formats/columns.hpp"

namespace agrisee::io {

/// A property of an element, as the header declares it.
struct PlyProperty {
  std::string name;
  Scalar type = Scalar::f32;  ///< of the number, or of the numbers in the list
  bool is_list = false;
  Scalar count_type = Scalar::u8;  ///< type of the length of a list
};

/// An element, as the header declares it: `count` records with these properties.
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_list() const;
  /// Size of a record (bytes) if all its lists are empty.
  std::size_t record_size() const;
  /// Index of the first property with one of these names, or -1.
  int find(std::initializer_list<const char*> names) const;
};

/// An open PLY file. The header has been read, and the file is large enough for the records that it promises. Binary
/// elements without lists are read block by block; all other files are read into memory at once.
class PlyDocument {
 public:
  /// What to read of an element: a sink for every property (empty to skip it), and one list, for which `on_list` is
  /// called with each record.
  struct Wanted {
    std::vector<Sink> sinks;
    int list = -1;  ///< index of the list property to read, or -1
    std::function<void(std::size_t record, const std::vector<double>& values)> on_list;
  };

  /// Open a file and read its header. @throws FileError when it cannot be read or is not a PLY file
  explicit PlyDocument(const std::filesystem::path& path);

  /// The element of that name, or nullptr.
  const PlyElement* find(const char* name) const;
  /// Read these elements and skip the others. May be called once.
  /// @throws FileError if the file is truncated or holds something that is not a number
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
  Bytes bytes_;  // the beginning of the file, or the whole file
  std::vector<PlyElement> elements_;
  bool ascii_ = false, swapped_ = false;
  std::size_t size_ = 0;       // size of the file (bytes)
  std::size_t body_ = 0;       // offset of the next byte to be read; at first that of the first record
  std::size_t body_line_ = 0;  // number of the line of the first record
};

}  // namespace agrisee::io
