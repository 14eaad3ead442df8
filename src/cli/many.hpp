// SPDX-License-Identifier: BSD-3-Clause
// Many scenes or clouds in one call, which can be distributed over several machines. Each input gets its own folder and
// a line in a summary. If one fails, the others are still processed. What is done is not done again.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "summary.hpp"

namespace agrisee::cli {

/// Read "I/N"; an empty text means the whole list. @throws UsageError for any other text
Shard parse_shard(const std::string& text);

/// An input, and the name of the folder for its result inside the output folder.
struct Job {
  std::string input, folder;
};

/// The files that paths and patterns (*, ?, [...]) name, each once, in the given order; the matches of a pattern are
/// sorted. The folder of a file is named after the file, preceded by the names of as many of the folders above as are
/// needed to distinguish it from the others ("truss_7/scene.yaml" becomes truss_7). The names do not depend on the
/// shard. An input that has a folder in `output` (job.json) keeps it, and a folder of another input is not taken.
/// @throws FileError for a pattern that matches nothing
std::vector<Job> jobs_of(const std::vector<std::string>& inputs, const std::string& output);

/// How to begin with a folder.
enum class Begin {
  as_asked,  ///< as the command line says
  again,     ///< replace what is there
  resume     ///< continue what was interrupted, or begin it again
};

/// What a list does with each of its inputs.
struct ListedCommand {
  std::string name;                     ///< "scan" or "process"
  bool force = false;                   ///< run all inputs again
  bool json = false;                    ///< standard output is for programs
  std::vector<std::string> files = {};  ///< that all inputs use, such as that of --params
  /// Does one input. An exception counts as a failure.
  std::function<void(const std::string& input, const std::string& folder, Begin begin)> run;
  /// Fingerprint of all that changes the result of an input: its files, parameters, version. Empty: not known, so that
  /// it is always run.
  std::function<std::string(const std::string& input)> key;
  /// Whether a folder holds all files that are asked for.
  std::function<bool(const std::string& folder)> is_complete;
};

/// Run the jobs of a shard one after the other. Those whose folder holds a result with the same key (job.json) are
/// skipped, those whose key has changed are run again. After each, OUTPUT/summary.csv, or summary-I-of-N.csv, is
/// rewritten. Jobs in whose folder another process works come last; if it still does, they stay open.
/// @return kSuccess, or kBadInput if any job failed or stays open; their messages are repeated at the end
int run_jobs(const std::vector<Job>& jobs, const Shard& shard, const std::string& output, const ListedCommand& command);

/// Whether inputs are a list: several, a pattern, or a shard.
bool is_list(const std::vector<std::string>& inputs, const std::string& shard);

/// Run all inputs. The result of a single input goes into `output` itself. Several inputs, a pattern, or a shard are
/// run as jobs, each in its own folder inside `output`. Without any input, `run` is called once with an empty name (a
/// scan that is resumed).
int run_inputs(const std::vector<std::string>& inputs, const std::string& shard, const std::string& output,
               const ListedCommand& command);

/// Add the option --shard.
void add_shard_option(CLI::App& command, std::string& shard);

}  // namespace agrisee::cli
