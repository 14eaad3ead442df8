// SPDX-License-Identifier: BSD-3-Clause
// agrisee merge: one summary from those of all shards, and one database from the results of a season.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "season.hpp"
#include "summary.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

struct MergeOptions {
  std::vector<std::string> folders;
  bool unfinished = false;
  SeasonOptions season;
};

/// Print the shards to run again, as `sbatch --array` takes them; nothing if there is none.
int print_unfinished(const fs::path& folder) {
  const ShardSummaries shards = read_shards(folder);
  if (shards.count == 0) throw FileError(folder.string() + ": holds no summary of a shard (summary-I-of-N.csv)");
  if (const std::string list = comma_list(shards.unfinished()); !list.empty()) std::cout << list << "\n";
  return kSuccess;
}

/// Why the summaries of shards are not those of a whole list; empty: they are.
std::string what_is_missing(const fs::path& folder, const ShardSummaries& shards) {
  if (!shards.missing.empty()) {
    const std::string first = (folder / summary_name({shards.missing.front(), shards.count})).string();
    return first + ": is missing" +
           (shards.missing.size() > 1 ? "; shards " + comma_list(shards.missing) + " have no summary" : "");
  }
  if (shards.stale.empty()) return "";
  return folder.string() + ": the shards have not seen the same list of inputs, as when files came while they ran. " +
         "Run shards " + comma_list(shards.unfinished()) + " again; what is done is skipped";
}

/// Join DIR/summary-I-of-N.csv of all shards to DIR/summary.csv.
/// @param must whether there have to be summaries, of all shards
/// @return kBadInput if any input is still open, or, unless they must be whole, a summary is missing or stale
/// @throws FileError if a summary that must be there is missing, or shards have not seen the same list
int join_summaries(const fs::path& folder, bool must) {
  const ShardSummaries shards = read_shards(folder);
  if (shards.count == 0 && !must) return kSuccess;
  if (shards.count == 0) throw FileError(folder.string() + ": holds no summary of a shard (summary-I-of-N.csv)");
  if (const std::string message = what_is_missing(folder, shards); !message.empty()) {
    if (must) throw FileError(message);
    std::cerr << "agrisee: " << message << "\n";
    return kBadInput;
  }
  const std::vector<SummaryRow> rows = shards.rows();
  const std::size_t open = count_status(rows, "open");
  write_summary(folder / "summary.csv", {rows, ""});
  std::cout << rows.size() << " results of " << shards.count << " shards, " << count_status(rows, "failed")
            << " failed: " << (folder / "summary.csv").string() << "\n";
  if (open == 0) return kSuccess;
  std::cerr << "agrisee: " << open << " inputs are open: a shard was stopped. Run shards "
            << comma_list(shards.unfinished()) << " again; what is done is skipped\n";
  return kBadInput;
}

int run_merge(const MergeOptions& options) {
  if (options.unfinished) {
    if (options.folders.size() > 1) throw UsageError("--unfinished: name one folder");
    return print_unfinished(options.folders.front());
  }
  int code = kSuccess;
  for (const std::string& folder : options.folders)
    code = std::max(code, join_summaries(folder, options.season.database.empty()));
  if (!options.season.database.empty()) code = std::max(code, add_to_season(options.folders, options.season));
  return code;
}

}  // namespace

void add_merge(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("merge", "join the summaries of shards, and put results into a database");
  auto options = std::make_shared<MergeOptions>();
  command
      ->add_option("folder", options->folders,
                   "output folders of scan or process with several inputs; those of shards hold summary-I-of-N.csv")
      ->required();
  add_season_options(*command, options->season);
  command
      ->add_flag("--unfinished", options->unfinished,
                 "only print the numbers of the shards to run again, separated by commas")
      ->excludes("--db");
  command->footer(
      "Without --db, merge only joins the summaries of shards. A list that ran without --shard has its summary.\n"
      "Examples:\n"
      "  agrisee merge results\n"
      "  left=$(agrisee merge results --unfinished); [ -z \"$left\" ] || sbatch --array=$left season.sh\n"
      "  agrisee merge results --db season.sqlite");
  command->callback([options, &run] { run = [options] { return run_merge(*options); }; });
}

}  // namespace agrisee::cli
