// SPDX-License-Identifier: BSD-3-Clause
#include "summary.hpp"

#include <agrisee/io/files.hpp>
#include <agrisee/io/fingerprint.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "io/formats/csv.hpp"

namespace agrisee::cli {
namespace {

constexpr const char* kSummaryHeader = "input,folder,status,fruits,views,stop_reason,seconds,message";
constexpr const char* kListColumn = ",list";  ///< in the summary of a shard

/// Whether a summary begins with this line. Shards of older versions have no column `list`.
bool is_header(std::string_view line) {
  return line == kSummaryHeader || line == std::string(kSummaryHeader) + kListColumn;
}

/// The shard that the name of a summary states; none for another name.
std::optional<Shard> shard_of(const std::string& name) {
  Shard shard;
  char end = 0;
  const int read = std::sscanf(name.c_str(), "summary-%zu-of-%zu.cs%c", &shard.index, &shard.count, &end);
  return read == 3 && end == 'v' ? std::optional(shard) : std::nullopt;
}

/// How many of `inputs` are those of shard `index` of `count`.
std::size_t size_of_shard(std::size_t inputs, std::size_t index, std::size_t count) {
  return inputs < index ? 0 : (inputs - index) / count + 1;
}

/// The shards that did not see the list that was written last: those of another list, of too few or too many inputs, or
/// that share an input.
/// @param lists the list of each shard; empty: not known, as it is of older versions and of shards without input
/// @param last the list that was written last; empty: not known
std::vector<std::size_t> stale_shards(const ShardSummaries& shards, const std::vector<std::string>& lists,
                                      const std::string& last) {
  std::size_t inputs = 0;
  for (const auto& part : shards.parts) inputs += part.size();
  if (!last.empty()) inputs = std::strtoull(last.c_str(), nullptr, 10);
  const bool known = !last.empty() || shards.missing.empty();  // how many inputs there are
  const std::set<std::size_t> missing(shards.missing.begin(), shards.missing.end());
  std::map<std::string, std::size_t> shard_of_input;
  std::set<std::size_t> out;
  for (std::size_t i = 1; i <= shards.count; ++i) {
    if (missing.count(i) > 0) continue;
    const auto& part = shards.parts[i - 1];
    const bool other = !lists[i - 1].empty() && lists[i - 1] != last;
    if (other || (known && part.size() != size_of_shard(inputs, i, shards.count))) out.insert(i);
  }
  for (std::size_t i = 1; i <= shards.count; ++i) {
    if (out.count(i) > 0) continue;
    for (const SummaryRow& row : shards.parts[i - 1])
      if (const auto [there, is_new] = shard_of_input.emplace(row.input, i); !is_new) out.insert({there->second, i});
  }
  return {out.begin(), out.end()};
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
  return std::getline(file, first) && is_header(first);
}

std::size_t count_status(const std::vector<SummaryRow>& rows, const std::string& status) {
  const auto has_it = [&](const SummaryRow& row) { return row.status == status; };
  return static_cast<std::size_t>(std::count_if(rows.begin(), rows.end(), has_it));
}

std::string list_mark(const std::vector<std::string>& inputs) {
  io::Fingerprint print;
  for (const std::string& input : inputs) print.add(input + "\n");
  return std::to_string(inputs.size()) + ":" + print.text();
}

void write_summary(const std::filesystem::path& path, const Summary& summary) {
  io::CsvWriter csv;
  for (const SummaryRow& row : summary.rows) {
    for (const std::string* cell :
         {&row.input, &row.folder, &row.status, &row.fruits, &row.views, &row.stop_reason, &row.seconds, &row.message})
      csv.cell(*cell);
    if (!summary.list.empty()) csv.cell(summary.list);
    csv.end_row();
  }
  io::write_file(path, std::string(kSummaryHeader) + (summary.list.empty() ? "" : kListColumn) + "\n" + csv.text());
}

Summary read_summary(const std::filesystem::path& path) {
  const io::Bytes bytes = io::read_bytes(path);
  io::Lines lines(bytes.view());
  std::string_view line;
  if (!lines.next(line) || !is_header(line)) io::fail(path, "is not a summary of many scans");
  const std::size_t columns = line == kSummaryHeader ? 8 : 9;
  Summary out;
  std::vector<std::string> cells;
  while (lines.next_filled(line)) {
    if (!io::split_csv(line, cells) || cells.size() != columns)
      io::fail(path, lines.number(), "expected " + std::to_string(columns) + " cells");
    out.rows.push_back({cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6], cells[7]});
    if (columns == 9) out.list = cells[8];
  }
  return out;
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
  std::set<std::size_t> out(missing.begin(), missing.end());
  out.insert(stale.begin(), stale.end());
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (count_status(parts[i], "ok") < parts[i].size()) out.insert(i + 1);
  return {out.begin(), out.end()};
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
  std::vector<std::string> lists(out.count);
  auto last = std::pair(std::filesystem::file_time_type::min(), std::string());  // when it was written, and what it is
  for (std::size_t i = 1; i <= out.count; ++i) {
    out.parts.emplace_back();
    if (found.begin()->second.count(i) == 0) {
      out.missing.push_back(i);
      continue;
    }
    const std::filesystem::path path = folder / summary_name({i, out.count});
    Summary summary = read_summary(path);
    out.parts.back() = std::move(summary.rows);
    lists[i - 1] = summary.list;
    if (!summary.list.empty()) last = std::max(last, {std::filesystem::last_write_time(path, ignored), summary.list});
  }
  out.stale = stale_shards(out, lists, last.second);
  return out;
}

void remove_replaced_shards(const std::filesystem::path& folder, const std::vector<std::string>& inputs) {
  const std::set<std::string> known(inputs.begin(), inputs.end());
  std::error_code error, ignored;
  const auto is_replaced = [&](const SummaryRow& row) {
    return known.count(row.input) > 0 || !std::filesystem::exists(row.input, ignored);
  };
  std::vector<std::filesystem::path> replaced;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (!shard_of(entry.path().filename().string()) || !is_summary(entry.path())) continue;
    const std::vector<SummaryRow> rows = read_summary(entry.path()).rows;
    if (!std::all_of(rows.begin(), rows.end(), is_replaced)) return;
    replaced.push_back(entry.path());
  }
  for (const std::filesystem::path& path : replaced) std::filesystem::remove(path, ignored);
}

std::string comma_list(const std::vector<std::size_t>& numbers) {
  std::string out;
  for (const std::size_t number : numbers) out += (out.empty() ? "" : ",") + std::to_string(number);
  return out;
}

}  // namespace agrisee::cli
