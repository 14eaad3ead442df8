// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The results of a season as they lie in folders, read for the database.
#pragma once

#include <agrisee/io/results.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace agrisee::season {

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
