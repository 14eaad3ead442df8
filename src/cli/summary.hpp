// SPDX-License-Identifier: BSD-3-Clause
// The summary of many scans: what became of each input of a list.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace agrisee::cli {

/// Part `index` (from 1) of `count` parts of a list of inputs.
struct Shard {
  std::size_t index = 1, count = 1;
};
constexpr std::size_t kMostShards = 1000000;  ///< more are a slip of the pen

/// One input of a list. `fruits` to `seconds` are those of its result, as texts; empty unless it is done.
struct SummaryRow {
  std::string input, folder;
  std::string status = "open";  ///< `open`: not run yet, or another process does it; `ok`, `failed`
  std::string fruits, views, stop_reason, seconds, message;
};

/// "summary.csv", or that of a shard: "summary-2-of-8.csv".
std::string summary_name(const Shard& shard);

/// Whether a file is a summary, or that of a shard, by its name and first line.
bool is_summary(const std::filesystem::path& path);

/// A summary, or that of a shard.
struct Summary {
  std::vector<SummaryRow> rows;
  std::string list;  ///< of a shard: what the whole list is known by (list_mark); empty: not known
};

/// How many rows have a status.
std::size_t count_status(const std::vector<SummaryRow>& rows, const std::string& status);

/// What a list of inputs is known by: their number and a fingerprint, "12:0123456789abcdef".
std::string list_mark(const std::vector<std::string>& inputs);

/// Write a summary; that of a shard has one more column, `list`. @throws FileError when it cannot be written
void write_summary(const std::filesystem::path& path, const Summary& summary);

/// Read a summary. @throws FileError if it is missing or something else
Summary read_summary(const std::filesystem::path& path);

/// The summaries of all shards of a folder.
struct ShardSummaries {
  std::size_t count = 0;                       ///< number of shards; 0: there is no summary of a shard
  std::vector<std::size_t> missing;            ///< shards without a summary: never started
  std::vector<std::size_t> stale;              ///< shards that saw another list than the shard that wrote last
  std::vector<std::vector<SummaryRow>> parts;  ///< of each shard; empty where it is missing

  /// The rows of all shards in the order of the list.
  std::vector<SummaryRow> rows() const;
  /// The shards to run again: those that are missing or stale, and those with an input that is open or failed.
  std::vector<std::size_t> unfinished() const;
};

/// Read all summaries of shards in a folder.
/// @throws FileError if it cannot be read, or holds summaries of different numbers of shards
ShardSummaries read_shards(const std::filesystem::path& folder);

/// Remove the summaries of shards in a folder which a list replaces: it has all inputs of all of them that
/// still exist.
void remove_replaced_shards(const std::filesystem::path& folder, const std::vector<std::string>& inputs);

/// Numbers separated by commas, as Slurm's `--array` takes them.
std::string comma_list(const std::vector<std::size_t>& numbers);

}  // namespace agrisee::cli
