// SPDX-License-Identifier: BSD-3-Clause
#include "summary.hpp"

#include <agrisee/io/files.hpp>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "io/formats/csv.hpp"

namespace agrisee::cli {
namespace {

constexpr const char* kSummaryHeader = "input,folder,status,fruits,views,stop_reason,seconds,message";

/// The shard that the name of a summary states; none for another name.
std::optional<Shard> shard_of(const std::string& name) {
  Shard shard;
  char end = 0;
  const int read = std::sscanf(name.c_str(), "summary-%zu-of-%zu.cs%c", &shard.index, &shard.count, &end);
  return read == 3 && end == 'v' ? std::optional(shard) : std::nullopt;
}

/// Whether all inputs of a shard are done.
bool is_done(const std::vector<SummaryRow>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const SummaryRow& row) { return row.status == "ok"; });
}

}  // namespace

std::string summary_name(const Shard& shard) {
  if (shard.count == 1) return "summary.csv";
  return "summary-" + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) + ".csv";
}

bool is_summary(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (name != "summary.csv" && !shard_of(name)) return false;
  std::string first;
  std::ifstream file(path);
  return std::getline(file, first) && first == kSummaryHeader;
}

void write_summary(const std::filesystem::path& path, const std::vector<SummaryRow>& rows) {
  io::CsvWriter csv;
  for (const SummaryRow& row : rows) {
    for (const std::string* cell :
         {&row.input, &row.folder, &row.status, &row.fruits, &row.views, &row.stop_reason, &row.seconds, &row.message})
      csv.cell(*cell);
    csv.end_row();
  }
  io::write_file(path, std::string(kSummaryHeader) + "\n" + csv.text());
}

std::vector<SummaryRow> read_summary(const std::filesystem::path& path) {
  const io::Bytes bytes = io::read_bytes(path);
  io::Lines lines(bytes.view());
  std::string_view line;
  if (!lines.next(line) || line != kSummaryHeader) io::fail(path, "is not a summary of many scans");
  std::vector<SummaryRow> rows;
  std::vector<std::string> cells;
  while (lines.next_filled(line)) {
    if (!io::split_csv(line, cells) || cells.size() != 8) io::fail(path, lines.number(), "expected 8 cells");
    rows.push_back({cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6], cells[7]});
  }
  return rows;
}

std::vector<SummaryRow> ShardSummaries::rows() const {
  // Shard i holds the inputs i, i + N, and so on. Taking one from each in turn restores the order of the list.
  std::vector<SummaryRow> out;
  for (std::size_t k = 0, more = 1; more > 0; ++k) {
    more = 0;
    for (const auto& part : parts)
      if (k < part.size()) out.push_back(part[k]), ++more;
  }
  return out;
}

std::vector<std::size_t> ShardSummaries::unfinished() const {
  std::vector<std::size_t> out = missing;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (!is_done(parts[i])) out.push_back(i + 1);
  std::sort(out.begin(), out.end());
  return out;
}

ShardSummaries read_shards(const std::filesystem::path& folder) {
  std::map<std::size_t, std::set<std::size_t>> found;              // for each N, the I that exist
  std::map<std::size_t, std::filesystem::file_time_type> written;  // for each N, last
  std::error_code error, ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const auto shard = shard_of(entry.path().filename().string());
    if (!shard) continue;
    found[shard->count].insert(shard->index);
    const auto time = std::filesystem::last_write_time(entry.path(), ignored);
    const auto known = written.emplace(shard->count, time).first;
    known->second = std::max(known->second, time);
  }
  if (error) io::fail(folder, error.message());
  if (found.size() > 1) {
    const auto newest = std::max_element(written.begin(), written.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
    std::string stale;
    for (const auto& [count, indices] : found)
      if (count != newest->first)
        stale += (stale.empty() ? "summary-*-of-" : ", summary-*-of-") + std::to_string(count) + ".csv";
    io::fail(folder, "holds summaries of different numbers of shards. The last that were written are of " +
                         std::to_string(newest->first) + "; if these are to stay, delete " + stale);
  }
  ShardSummaries out;
  if (found.empty()) return out;
  if (found.begin()->first > kMostShards)
    io::fail(folder, "holds the summary of one of " + std::to_string(found.begin()->first) + " shards, at most " +
                         std::to_string(kMostShards) + " are possible");
  out.count = found.begin()->first;
  for (std::size_t i = 1; i <= out.count; ++i) {
    const bool is_there = found.begin()->second.count(i) > 0;
    if (!is_there) out.missing.push_back(i);
    out.parts.push_back(is_there ? read_summary(folder / summary_name({i, out.count})) : std::vector<SummaryRow>());
  }
  return out;
}

std::string comma_list(const std::vector<std::size_t>& numbers) {
  std::string out;
  for (const std::size_t number : numbers) out += (out.empty() ? "" : ",") + std::to_string(number);
  return out;
}

}  // namespace agrisee::cli
