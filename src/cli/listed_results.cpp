// SPDX-License-Identifier: BSD-3-Clause
#ifdef AGRISEE_HAS_SQLITE
#include "listed_results.hpp"

#include <agrisee/core/error.hpp>

#include <map>
#include <set>

#include "summary.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

/// What the summaries in a folder say.
struct Listed {
  std::map<std::string, SummaryRow> rows;        ///< by the folder of the result
  std::map<std::string, std::string> folder_of;  ///< of each input
};

/// All summaries in a folder. Those of shards, which may not be merged yet, count more than that of the whole list.
Listed listed_in(const fs::path& folder) {
  std::error_code error;
  std::vector<std::vector<SummaryRow>> parts = read_shards(folder).parts;
  if (fs::exists(folder / "summary.csv", error)) parts.push_back(read_summary(folder / "summary.csv").rows);
  Listed out;
  for (const auto& part : parts)
    for (const SummaryRow& row : part) {
      out.rows.emplace(row.folder, row);
      out.folder_of.emplace(row.input, row.folder);
    }
  return out;
}

/// A path as a summary holds it: without line breaks.
std::string as_listed(std::string path) {
  for (char& c : path)
    if (c == '\n' || c == '\r') c = ' ';
  return path;
}

/// Why a result does not count beside those that are listed; empty: it does.
std::string why_left_out(const season::Scan& scan, const Listed& listed) {
  if (listed.rows.empty() || scan.input.empty()) return "";
  if (listed.rows.count(as_listed(scan.folder.filename().string())) > 0) return "";
  if (const auto other = listed.folder_of.find(as_listed(scan.input)); other != listed.folder_of.end())
    return scan.input + " is now in " + other->second;
  std::error_code error;
  return fs::exists(scan.input, error) ? "" : "its input " + scan.input + " is gone, and no list names it";
}

/// Add the inputs of a list that have no result. @param done names of the folders with a result, as they are listed
void add_without_result(const fs::path& folder, const Listed& listed, const std::set<std::string>& done,
                        ListedResults& found) {
  for (const auto& [name, row] : listed.rows) {
    if (done.count(name) > 0) continue;
    if (row.status == "ok") {
      found.faults.push_back((folder / name).string() +
                             ": is listed as ok, but its result is gone; run the list again");
      continue;
    }
    season::Scan scan;
    scan.folder = folder / name;
    scan.status = row.status;
    scan.message = row.message;
    scan.input = row.input;
    scan.content = row.status + ": " + row.message;
    found.scans.push_back(scan);
  }
}

}  // namespace

void collect_results(const fs::path& folder, ListedResults& found) {
  const fs::path top = fs::path(folder / "").parent_path();  // without a slash behind it
  std::map<fs::path, Listed> lists{{top, listed_in(top)}};
  const std::vector<fs::path> results = season::result_folders(top);
  if (results.empty() && lists[top].rows.empty())
    throw FileError(folder.string() + ": holds no result of agrisee (run.json), nor does a folder in it");
  std::map<fs::path, std::set<std::string>> done;
  for (const fs::path& result : results) {
    const fs::path parent = result == top ? fs::path() : result.parent_path();
    done[parent].insert(as_listed(result.filename().string()));
    season::Scan scan;
    try {
      scan = season::open_result(result);
    } catch (const FileError& e) {
      found.faults.emplace_back(e.what());
      continue;
    }
    if (!parent.empty() && lists.count(parent) == 0) lists[parent] = listed_in(parent);
    const std::string why = why_left_out(scan, lists[parent]);
    (why.empty() ? found.scans : found.left_out).push_back(scan);
    if (!why.empty()) found.notes.push_back(result.string() + ": left out; " + why);
  }
  for (const auto& [path, listed] : lists) add_without_result(path, listed, done[path], found);
}

}  // namespace agrisee::cli
#endif
