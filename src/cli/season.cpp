// SPDX-License-Identifier: BSD-3-Clause
// The database of a season: what `agrisee merge --db` puts into it, and `agrisee season`, its page.
#include "season.hpp"

#include <agrisee/io/files.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

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

/// A regular expression of the command line; none for an empty text. @throws UsageError if it cannot be used
std::optional<season::PathPattern> pattern_of(const char* option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  try {
    return season::PathPattern(text);
  } catch (const ParameterError& e) {
    throw UsageError(std::string(option) + ": " + e.what());
  }
}

/// Tell of a regular expression that is in the path of no scan, and of paths with two dates.
void tell_places(const SeasonOptions& options, const std::vector<season::Scan>& scans,
                 const std::vector<season::Place>& places) {
  const auto path_of = [&](std::size_t i) {
    return scans[i].input.empty() ? scans[i].folder.string() : scans[i].input;
  };
  const auto tell_unmatched = [&](const char* option, const std::string& pattern, std::string season::Place::*part) {
    const auto has_it = [&](const season::Place& place) { return !(place.*part).empty(); };
    if (!pattern.empty() && !places.empty() && std::none_of(places.begin(), places.end(), has_it))
      std::cerr << "agrisee: " << option << ": '" << pattern << "' is in the path of no input, such as '" << path_of(0)
                << "'\n";
  };
  tell_unmatched("--row", options.row, &season::Place::row);
  tell_unmatched("--date", options.date, &season::Place::date);
  const auto has_two = [](const season::Place& place) { return !place.other_date.empty(); };
  const auto first = std::find_if(places.begin(), places.end(), has_two);
  if (first == places.end()) return;
  std::cerr << "agrisee: paths with two dates: " << std::count_if(first, places.end(), has_two) << ", such as '"
            << path_of(static_cast<std::size_t>(first - places.begin())) << "', of which " << first->date
            << " counts; --date chooses another\n";
}

int run_season(const PageOptions& options) {
  std::error_code error;
  if (fs::equivalent(options.database, options.output, error))
    throw UsageError(options.output + ": is the database, which the page would replace; name another file");
  if (!options.force && fs::exists(options.output, error))
    throw UsageError(options.output + ": exists; use --force to overwrite it");
  const season::Overview overview = season::read_overview(options.database);
  io::write_file(options.output, season::season_page(overview, fs::path(options.database).stem().string()));
  const season::Tally all = overview.all(), last = overview.of_date(overview.last_date());
  const std::size_t dates = overview.dates().size();
  std::cout << last.fruit << " fruit in " << last.scans << " scans on " << overview.last_date()
            << (dates > 1 ? ", the last of " + std::to_string(dates) + " dates" : "") << "; in all " << all.scans
            << " scans, " << all.failed << " without a result: " << options.output << "\n";
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
  const season::PlaceRules rules{pattern_of("--row", options.row), pattern_of("--date", options.date)};
  ListedResults found;
  for (const std::string& folder : folders) collect_results(folder, found);
  for (const std::string& note : found.notes) std::cerr << "agrisee: " << note << "\n";
  season::Added added =
      season::add_scans(options.database, found.scans, found.left_out, rules, threads_of(options.threads));
  const std::size_t without = added.failed + added.open;
  std::cout << added.added << " scans added, " << added.changed << " replaced, " << added.unchanged << " were there"
            << (added.moved > 0 ? ", " + std::to_string(added.moved) + " moved" : "")
            << (added.removed > 0 ? ", " + std::to_string(added.removed) + " removed" : "")
            << (without > 0 ? ", " + std::to_string(without) + " without a result" : "") << ": " << options.database
            << "\n";
  if (added.open > 0)
    std::cerr << "agrisee: " << added.open << (added.open == 1 ? " input is" : " inputs are")
              << " open: a list was stopped. Run it again; what is done is skipped\n";
  if (added.twice > 0)
    std::cerr << "agrisee: " << added.twice << (added.twice == 1 ? " scan is" : " scans are")
              << " in the database twice, such as " << added.example
              << "; delete one of the folders, and merge the other again\n";
  tell_places(options, found.scans, added.places);
  found.faults.insert(found.faults.end(), added.unread.begin(), added.unread.end());
  for (const std::string& fault : found.faults) std::cerr << "agrisee: left out: " << fault << "\n";
  return found.faults.empty() && added.open == 0 ? kSuccess : kBadInput;
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
