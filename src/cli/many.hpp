// SPDX-License-Identifier: BSD-3-Clause
// Many scenes or clouds in one call, and a season of them spread over many machines: each input gets a folder of its
// own and a line in a summary; one that fails does not stop the rest.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace agrisee::cli {

/// The I-th of N parts of a list of inputs, counted from 1.
struct Shard {
  std::size_t index = 1, count = 1;
};

/// "I/N", or everything for an empty text. @throws UsageError
Shard parse_shard(const std::string& text);

/// An input and the folder of its result, below the output folder.
struct Job {
  std::string input, folder;
};

/// The files that paths and patterns (*, ?, [...]) name, each once, in the order given and patterns sorted; folders by
/// the files' names, with as many of the folders above in front as it takes to tell them apart ("truss_7/scene.yaml" is
/// truss_7). The same for the same inputs, whatever the shard. @throws UsageError for a pattern that matches nothing
std::vector<Job> jobs_of(const std::vector<std::string>& inputs);

/// Runs the shard's jobs one after the other and writes OUTPUT/summary.csv, or summary-I-of-N.csv, anew after each.
/// @param run does one job with the folder to write to, and returns its exit code; what it throws is a failure too
/// @return kSuccess, or kBadInput when any failed (their messages are repeated at the end)
using RunOne = std::function<int(const std::string& input, const std::string& folder)>;
int run_jobs(const std::vector<Job>& jobs, const Shard& shard, const std::string& output, const RunOne& run);

/// One input goes to `output` itself; several, a pattern, or a shard of them are jobs, each with a folder below it. No
/// input at all (a scan that is resumed) is one without a name.
int run_inputs(const std::vector<std::string>& inputs, const std::string& shard, const std::string& output,
               const RunOne& run);

void add_shard_option(CLI::App& command, std::string& shard);

}  // namespace agrisee::cli
