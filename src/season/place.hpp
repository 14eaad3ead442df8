// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Row and date of a scan, read from a path.
#pragma once

#include <optional>
#include <regex>
#include <string>
#include <vector>

namespace agrisee::season {

/// Where in a greenhouse a scan was made, and when.
struct Place {
  std::string row;         ///< of plants; empty: not known
  std::string date;        ///< "2026-06-03"; empty: not known
  std::string other_date;  ///< another one that the path holds, too; empty: none
};

/// A regular expression for paths (ECMAScript, letters of either case), with groups in parentheses. The time of a
/// search grows with the length of the path, not exponentially, so references to groups (\1) are not possible.
class PathPattern {
 public:
  /// @throws ParameterError if the text is no regular expression, or has no group
  explicit PathPattern(const std::string& text);

  /// All matches in a path in their order: the texts of the groups. @throws ParameterError if it takes too long
  std::vector<std::vector<std::string>> matches(const std::string& path) const;

 private:
  std::string text_;
  std::regex pattern_;
};

/// Reads row and date from the path of a scan's input: the groups of the last match, joined by "-". Without a match it
/// is empty. Zeros before a row do not count.
struct PlaceRules {
  std::optional<PathPattern> row;   ///< none: "row_07" -> "7", "row12b" -> "12b", "row12plant3" -> "12"
  std::optional<PathPattern> date;  ///< none: "20260603" -> "2026-06-03", if there is such a day

  /// The place that a path tells.
  Place of(const std::string& path) const;
};

}  // namespace agrisee::season
