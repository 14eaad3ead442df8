// SPDX-License-Identifier: BSD-3-Clause
// What `agrisee merge` does with the results of a season.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace agrisee::cli {

/// Options of `merge` for the database.
struct SeasonOptions {
  std::string database;   ///< file; empty: none
  std::string row, date;  ///< regular expressions; empty: the defaults of season::PlaceRules
  int threads = 0;        ///< 0: one per core
};

/// Add --db, --row, --date and --threads.
void add_season_options(CLI::App& command, SeasonOptions& options);

/// Put all results in some folders, at any depth, into the database, and print how many are new.
/// @return kBadInput if results cannot be read or inputs are open, which is told
/// @throws UsageError without SQLite, or for a regular expression that is none; FileError for a folder without results
int add_to_season(const std::vector<std::string>& folders, const SeasonOptions& options);

}  // namespace agrisee::cli
