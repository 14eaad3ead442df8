// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/csv.hpp"

namespace agrisee::io {

void CsvWriter::cell(std::string_view text) {
  if (!first_) text_ += ',';
  first_ = false;
  if (text.find_first_of(",\"\n\r") == std::string_view::npos) {
    text_ += text;
    return;
  }
  text_ += '"';
  for (const char c : text) {
    if (c == '"') text_ += '"';
    text_ += c == '\n' || c == '\r' ? ' ' : c;
  }
  text_ += '"';
}

char csv_separator(std::string_view head) {
  const auto has = [&](char c) { return head.find(c) != std::string_view::npos; };
  return has(';') && !has(',') ? ';' : ',';
}

bool split_csv(std::string_view line, std::vector<std::string>& cells, char separator) {
  cells.assign(1, "");
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return !quoted;
}

}  // namespace agrisee::io
