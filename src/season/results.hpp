// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The results of a season as they lie in folders, read for the database.
#pragma once

#include <agrisee/io/results.hpp>

#include <filesystem>
#include <optional>
#include <regex>
#include <string>
#include <vector>

namespace agrisee::season {

/// Where in a greenhouse a scan was made, and when.
struct Place {
  std::string row;   ///< of plants; empty: not known
  std::string date;  ///< "2026-06-03"; empty: not known
};

/// Reads row and date from the path of a scan's input: the groups in parentheses of a match, joined by "-". Without a
/// match it is empty.
struct PlaceRules {
  std::regex row{"(?:^|[^a-z])row[ _-]?([0-9]+[a-z]?)", std::regex::icase};  ///< "row_07" -> "07"
  std::regex date{"(?:^|[^0-9])(20[0-9]{2})[-_]?(0[1-9]|1[0-2])[-_]?(0[1-9]|[12][0-9]|3[01])(?![0-9])"};
  ///< "20260603" -> "2026-06-03"

  /// The place that a path tells.
  Place of(const std::string& path) const;
};

/// A scan, finished or not. Where it is not `ok`, there is no result.
struct Scan {
  std::filesystem::path folder;  ///< of the result
  std::string status = "ok";     ///< `ok`, `failed` or `open`, as in summary.csv
  std::string message;           ///< why it failed
  std::string input;             ///< as in the list; empty: not known
  std::string content;           ///< fingerprint of the files that are read
};

/// What is read of a result.
struct ResultFiles {
  io::RunFile run;
  std::vector<Fruit> fruits;
  std::vector<View> views;
};

/// Folders with a result (run.json) in and below a folder, sorted. @throws FileError when it cannot be read
std::vector<std::filesystem::path> result_folders(const std::filesystem::path& folder);

/// A scan of which `folder` holds the result, with the input that job.json names. @throws FileError
Scan open_result(const std::filesystem::path& folder);

/// Read a result. @throws FileError
ResultFiles read_result(const std::filesystem::path& folder);

}  // namespace agrisee::season
