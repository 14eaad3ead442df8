// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Comma-separated values (RFC 4180, but without line breaks inside of cells).
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <string>
#include <vector>

#include "io/formats/text.hpp"

namespace agrisee::io {

/// Composes a table cell by cell.
class CsvWriter {
 public:
  /// Append a cell to the row. Texts are quoted if necessary; line breaks in them become blanks.
  void cell(std::string_view text);
  void cell(const char* text) { cell(std::string_view(text)); }
  void cell(double value) { cell(format(value)); }
  void cell(std::size_t value) { cell(std::to_string(value)); }
  /// Append one cell per coefficient.
  template <typename D>
  void cells(const Eigen::MatrixBase<D>& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) cell(values(i));
  }
  void empty_cells(int count) {
    for (int i = 0; i < count; ++i) cell("");
  }
  void end_row() { text_ += '\n', first_ = true; }
  /// All rows so far.
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool first_ = true;
};

/// The separator of a table's cells, by its first line: a semicolon if it has one and no comma, otherwise a comma.
char csv_separator(std::string_view head);

/// Split a line into its cells. @return false if a quote is not closed
bool split_csv(std::string_view line, std::vector<std::string>& cells, char separator = ',');

}  // namespace agrisee::io
