// SPDX-License-Identifier: BSD-3-Clause
// Many scenes or clouds in one call, which can be distributed over several machines. Each input gets its own folder and
// a line in a summary. If one fails, the others are still processed.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace agrisee::cli {

/// Part `index` (from 1) of `count` parts of a list of inputs.
struct Shard {
  std::size_t index = 1, count = 1;
};

/// Read "I/N"; an empty text means the whole list. @throws UsageError for any other text
Shard parse_shard(const std::string& text);

/// An input, and the name of the folder for its result inside the output folder.
struct Job {
  std::string input, folder;
};

/// The files that paths and patterns (*, ?, [...]) name, each once, in the given order; the matches of a pattern are
/// sorted. The folder of a file is named after the file, preceded by the names of as many of the folders above as are
/// needed to distinguish it from the others ("truss_7/scene.yaml" becomes truss_7). The names do not depend on the
/// shard.
/// @throws UsageError for a pattern that matches nothing
std::vector<Job> jobs_of(const std::vector<std::string>& inputs);

/// Does one job and returns its exit code. An exception counts as a failure of the job.
using RunOne = std::function<int(const std::string& input, const std::string& folder)>;
/// Run the jobs of a shard one after the other. After each, OUTPUT/summary.csv, or summary-I-of-N.csv, is rewritten.
/// @return kSuccess, or kBadInput if any job failed; the messages of failed jobs are repeated at the end
int run_jobs(const std::vector<Job>& jobs, const Shard& shard, const std::string& output, const RunOne& run);

/// Run all inputs. The result of a single input goes into `output` itself. Several inputs, a pattern, or a shard are
/// run as jobs, each in its own folder inside `output`. Without any input, `run` is called once with an empty name (a
/// scan that is resumed).
int run_inputs(const std::vector<std::string>& inputs, const std::string& shard, const std::string& output,
               const RunOne& run);

/// Add the option --shard.
void add_shard_option(CLI::App& command, std::string& shard);

}  // namespace agrisee::cli
