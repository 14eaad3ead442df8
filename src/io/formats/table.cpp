// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/table.hpp"

#include <agrisee/io/cloud_file.hpp>
#include <agrisee/io/files.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "io/formats/cloud_columns.hpp"
#include "io/formats/csv.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io {
namespace {

using Cells = std::vector<std::string_view>;

/// The separator of the cells in a line: a comma or semicolon where there is one, otherwise blanks.
char separator_of(std::string_view line) {
  const char separator = csv_separator(line);
  return line.find(separator) != std::string_view::npos ? separator : ' ';
}

void split(std::string_view line, char separator, Cells& cells) {
  cells.clear();
  if (separator == ' ') {
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) cells.push_back(word);
    return;
  }
  while (true) {
    const std::size_t end = line.find(separator);
    std::string_view cell = trimmed(line.substr(0, end));
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
    cells.push_back(cell);
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

bool is_comment(std::string_view line) { return line.substr(0, 1) == "#" || line.substr(0, 2) == "//"; }

/// Where the rows of a table begin, and what its columns are called.
struct Head {
  char separator = ' ';
  std::vector<std::string> names;  ///< in lower case; if nobody states them, x, y, z and empty ones
};

/// The names in a line, comment or not. @return false if x, y and z are not among them
bool names_in(std::string_view line, Head& head) {
  while (!line.empty() && (line.front() == '#' || line.front() == '/')) line.remove_prefix(1);
  head.separator = separator_of(line);
  Cells cells;
  split(line, head.separator, cells);
  head.names.clear();
  for (const std::string_view cell : cells) head.names.push_back(lower(cell));
  const auto has = [&](const char* name) {
    return std::find(head.names.begin(), head.names.end(), name) != head.names.end();
  };
  return has("x") && has("y") && has("z");
}

/// Read up to the line before the first row. @return false if there is neither a row of numbers nor one of names
bool read_head(Lines& lines, Head& head, std::string_view& first_row) {
  std::string_view line;
  while (lines.next_filled(line)) {
    if (names_in(line, head)) return first_row = {}, true;
    if (is_comment(line)) continue;
    first_row = line;
    head.separator = separator_of(line);
    Cells cells;
    split(line, head.separator, cells);
    head.names.assign(cells.size(), "");
    for (std::size_t i = 0; i < 3 && i < cells.size(); ++i) head.names[i] = "xyz"[i];
    return cells.size() >= 3 &&
           std::all_of(cells.begin(), cells.begin() + 3, [](std::string_view c) { return to_number(c).has_value(); });
  }
  return false;
}

/// Call visit(line) for every row of numbers.
template <typename Visit>
void for_each_row(Lines lines, std::string_view first_row, Visit&& visit) {
  std::string_view line = first_row;
  if (!first_row.empty()) visit(line, lines.number());
  while (lines.next_filled(line))
    if (!is_comment(line)) visit(line, lines.number());
}

}  // namespace

bool is_table(std::string_view first_bytes) {
  if (first_bytes.find('\0') != std::string_view::npos) return false;
  Lines lines(first_bytes);
  Head head;
  std::string_view row;
  return read_head(lines, head, row);
}

CloudFile read_table_cloud(const std::filesystem::path& path, NonFinite non_finite) {
  const Bytes bytes = read_bytes(path);
  if (bytes.size == 0) fail(path, "is empty");
  Lines lines(bytes.view());
  Head head;
  std::string_view first_row;
  if (!read_head(lines, head, first_row))
    fail(path, "is no table of points: it has neither a line that names the columns x, y and z nor a line of numbers");
  if (std::find(head.names.begin(), head.names.end(), "points_new") != head.names.end())
    fail(path, "lists the views of a scan, and no points: give it with --views, beside a cloud");
  std::size_t points = 0;
  for_each_row(lines, first_row, [&](std::string_view, std::size_t) { ++points; });
  CloudColumns cloud(path, points, head.names);
  std::vector<Sink> sinks;
  for (auto name = head.names.begin(); name != head.names.end(); ++name) {
    sinks.push_back(cloud.sink(*name));
    if (sinks.back() && std::find(head.names.begin(), name, *name) != name)
      fail(path, lines.number(), "two columns are called " + excerpt(*name));
  }
  Cells cells;
  std::size_t row = 0;
  for_each_row(lines, first_row, [&](std::string_view line, std::size_t number) {
    split(line, head.separator, cells);
    if (cells.size() != sinks.size())
      fail(path, number, "expected " + std::to_string(sinks.size()) + " numbers, got " + std::to_string(cells.size()));
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (!sinks[c]) continue;
      const bool unknown = cells[c].empty() && sinks[c].floats;
      const auto value = unknown ? std::numeric_limits<double>::quiet_NaN() : to_number(cells[c]);
      if (!value || !sinks[c].store(row, *value))
        fail(path, number,
             head.names[c] + ": " + excerpt(cells[c]) + " is not a number" + (value ? " that can stand there" : ""));
    }
    ++row;
  });
  return cloud.finish(non_finite, points, 1);
}

}  // namespace agrisee::io
