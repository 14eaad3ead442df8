// SPDX-License-Identifier: BSD-3-Clause
// The database of a season: what `agrisee merge --db` puts into it, and `agrisee season`, its page.
#include "season.hpp"

#include <agrisee/io/files.hpp>

#include <filesystem>
#include <iostream>
#include <map>
#include <memory>

#include "commands.hpp"
#include "summary.hpp"
#ifdef AGRISEE_HAS_SQLITE
#include "season/database.hpp"
#include "season/page.hpp"
#endif

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

struct PageOptions {
  std::string database, output;
  bool force = false;
};

#ifdef AGRISEE_HAS_SQLITE

/// A regular expression of the command line. @throws UsageError if it is none
std::regex pattern_of(const char* option, const std::string& text) {
  try {
    return std::regex(text, std::regex::icase);
  } catch (const std::regex_error& e) {
    throw UsageError(std::string(option) + ": '" + text + "' is not a regular expression: " + e.what());
  }
}

/// All scans of an output folder: its results, and the inputs of its list that have none. A result whose input the list
/// puts into another folder is left over from an older list, and is left out.
void collect_scans(const fs::path& folder, std::vector<season::Scan>& scans, std::vector<fs::path>& left_out) {
  std::error_code error;
  std::vector<SummaryRow> list;
  if (fs::exists(folder / "summary.csv", error)) list = read_summary(folder / "summary.csv");
  std::map<std::string, std::string> folder_of;
  for (const SummaryRow& row : list) folder_of[row.input] = row.folder;
  for (const fs::path& result : season::result_folders(folder)) {
    const season::Scan scan = season::open_result(result);
    const auto listed = folder_of.find(scan.input);
    if (listed == folder_of.end() || (folder / listed->second).lexically_normal() == result.lexically_normal()) {
      scans.push_back(scan);
      continue;
    }
    left_out.push_back(result);
    std::cerr << result.string() << ": left out; " << scan.input << " is now in " << listed->second << "\n";
  }
  for (const SummaryRow& row : list) {
    if (row.status == "ok" || fs::exists(folder / row.folder / "run.json", error)) continue;
    season::Scan scan;
    scan.folder = folder / row.folder;
    scan.status = row.status;
    scan.message = row.message;
    scan.input = row.input;
    scan.content = row.status + ": " + row.message;
    scans.push_back(scan);
  }
}

int run_season(const PageOptions& options) {
  std::error_code error;
  if (fs::equivalent(options.database, options.output, error))
    throw UsageError(options.output + ": is the database, which the page would replace; name another file");
  if (!options.force && fs::exists(options.output, error))
    throw UsageError(options.output + ": exists; use --force to overwrite it");
  const season::Overview overview = season::read_overview(options.database);
  io::write_file(options.output, season::season_page(overview, fs::path(options.database).stem().string()));
  const season::Tally all = overview.all();
  std::cout << all.fruit << " fruit in " << all.scans << " scans, " << all.failed
            << " without a result: " << options.output << "\n";
  return kSuccess;
}

#else

constexpr const char* kNoSqlite =
    "this agrisee was built without SQLite; install libsqlite3-dev, then configure and build again";

int run_season(const PageOptions&) { throw UsageError(kNoSqlite); }

#endif

}  // namespace

void add_season_options(CLI::App& command, SeasonOptions& options) {
  auto* database = command.add_option("--db", options.database,
                                      "SQLite file for all results in the folders: scans, fruit, views; results that "
                                      "it already holds are skipped");
  command
      .add_option(
          "--row", options.row,
          "regular expression that finds the row of plants in the path of an input (default: row_07 and the like)")
      ->needs(database);
  command
      .add_option("--date", options.date,
                  "regular expression that finds the date in the path of an input (default: 2026-06-03 or 20260603, or "
                  "else the day of processing)")
      ->needs(database);
  command.add_option("--threads", options.threads, "number of threads that read results (0: one per core)")
      ->check(CLI::Range(0, 1024))
      ->needs(database);
}

#ifdef AGRISEE_HAS_SQLITE

void add_to_season(const std::vector<std::string>& folders, const SeasonOptions& options) {
  season::PlaceRules rules;
  if (!options.row.empty()) rules.row = pattern_of("--row", options.row);
  if (!options.date.empty()) rules.date = pattern_of("--date", options.date);
  std::vector<season::Scan> scans;
  std::vector<fs::path> left_out;
  for (const std::string& folder : folders) collect_scans(folder, scans, left_out);
  const season::Added added = season::add_scans(options.database, scans, left_out, rules, threads_of(options.threads));
  std::cout << added.added << " scans added, " << added.changed << " replaced, " << added.unchanged << " were there"
            << (added.removed > 0 ? ", " + std::to_string(added.removed) + " removed" : "") << ": " << options.database
            << "\n";
}

#else

void add_to_season(const std::vector<std::string>&, const SeasonOptions&) { throw UsageError(kNoSqlite); }

#endif

void add_season(CLI::App& app, Run& run) {
  auto* command =
      app.add_subcommand("season", "write a page about a season: numbers, sizes and ripeness by row and date");
  auto options = std::make_shared<PageOptions>();
  command->add_option("database", options->database, "SQLite file, as `agrisee merge --db` writes it")->required();
  command->add_option("-o,--output", options->output, "HTML file to write")->required();
  command->add_flag("--force", options->force, "overwrite the page");
  command->footer("Example:\n  agrisee season season.sqlite -o season.html");
  command->callback([options, &run] { run = [options] { return run_season(*options); }; });
}

}  // namespace agrisee::cli
