// SPDX-License-Identifier: BSD-3-Clause
// The database of a season: what `agrisee merge --db` puts into it, and `agrisee season`, its page.
#include "season.hpp"

#include <agrisee/io/files.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.hpp"
#ifdef AGRISEE_HAS_SQLITE
#include "listed_results.hpp"
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

/// A regular expression of the command line. @throws UsageError if it is none, or has no group
std::regex pattern_of(const char* option, const std::string& text) {
  try {
    std::regex pattern(text, std::regex::icase);
    if (pattern.mark_count() == 0)
      throw UsageError(std::string(option) + ": '" + text + "' has no group: put what is to be stored in parentheses");
    return pattern;
  } catch (const std::regex_error& e) {
    throw UsageError(std::string(option) + ": '" + text + "' is not a regular expression: " + e.what());
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
      .add_option("--row", options.row,
                  "regular expression whose group finds the row of plants in the path of an input (default: row_07 and "
                  "the like)")
      ->needs(database);
  command
      .add_option(
          "--date", options.date,
          "regular expression whose group finds the date in the path of an input (default: 2026-06-03 or 20260603, or "
          "else the day of processing)")
      ->needs(database);
  command.add_option("--threads", options.threads, "number of threads that read results (0: one per core)")
      ->check(CLI::Range(0, 1024))
      ->needs(database);
}

#ifdef AGRISEE_HAS_SQLITE

int add_to_season(const std::vector<std::string>& folders, const SeasonOptions& options) {
  season::PlaceRules rules;
  if (!options.row.empty()) rules.row = pattern_of("--row", options.row);
  if (!options.date.empty()) rules.date = pattern_of("--date", options.date);
  ListedResults found;
  for (const std::string& folder : folders) collect_results(folder, found);
  for (const std::string& note : found.notes) std::cerr << "agrisee: " << note << "\n";
  season::Added added =
      season::add_scans(options.database, found.scans, found.left_out, rules, threads_of(options.threads));
  std::cout << added.added << " scans added, " << added.changed << " replaced, " << added.unchanged << " were there"
            << (added.moved > 0 ? ", " + std::to_string(added.moved) + " moved" : "")
            << (added.removed > 0 ? ", " + std::to_string(added.removed) + " removed" : "") << ": " << options.database
            << "\n";
  if (added.twice > 0)
    std::cerr << "agrisee: " << added.twice << (added.twice == 1 ? " scan is" : " scans are")
              << " in the database twice, such as " << added.example
              << "; delete one of the folders, and merge the other again\n";
  const auto tell_unmatched = [&](const char* option, const std::string& pattern, std::string season::Place::*part) {
    const auto has_it = [&](const season::Scan& scan) {
      return !(rules.of(scan.input.empty() ? scan.folder.string() : scan.input).*part).empty();
    };
    if (!pattern.empty() && !found.scans.empty() && std::none_of(found.scans.begin(), found.scans.end(), has_it))
      std::cerr << "agrisee: " << option << ": '" << pattern << "' is in the path of no input, such as '"
                << found.scans.front().input << "'\n";
  };
  tell_unmatched("--row", options.row, &season::Place::row);
  tell_unmatched("--date", options.date, &season::Place::date);
  found.faults.insert(found.faults.end(), added.unread.begin(), added.unread.end());
  for (const std::string& fault : found.faults) std::cerr << "agrisee: left out: " << fault << "\n";
  return found.faults.empty() ? kSuccess : kBadInput;
}

#else

int add_to_season(const std::vector<std::string>&, const SeasonOptions&) { throw UsageError(kNoSqlite); }

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
