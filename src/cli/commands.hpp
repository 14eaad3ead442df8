// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of `agrisee`, and what they share. Results go to stdout, progress to stderr.
#pragma once

#include <agrisee/io/results.hpp>
#include <agrisee/parameters.hpp>

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace agrisee::cli {

/// Exit codes.
constexpr int kSuccess = 0, kUsage = 1, kBadInput = 2, kScanFailed = 3;

/// A command line that parses but asks for something that cannot be done.
struct UsageError : Error {
  using Error::Error;
};

/// Registers a subcommand; `run` is set to what it does when it is chosen, and returns the exit code.
using Run = std::function<int()>;
void add_scan(CLI::App& app, Run& run);
void add_process(CLI::App& app, Run& run);
void add_make_truss(CLI::App& app, Run& run);
void add_evaluate(CLI::App& app, Run& run);
void add_paper_scenes(CLI::App& app, Run& run);
void add_experiment(CLI::App& app, Run& run);
void add_limit(CLI::App& app, Run& run);
void add_merge(CLI::App& app, Run& run);
void add_faults(CLI::App& app, Run& run);

/// Options that scan and process have in common.
struct PipelineOptions {
  std::string preset = "default", params;
  std::string output;
  std::vector<double> radius;  ///< smallest and largest expected radius (m), or empty
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0 = as many as the machine has
  bool force = false, json = false;
};
/// @return the option that names the output
CLI::Option* add_pipeline_options(CLI::App& command, PipelineOptions& options);

/// Preset, parameter file and expected radii combined. @throws FileError, UsageError
Parameters parameters_of(const PipelineOptions& options);
int threads_of(int asked);

/// @throws UsageError when it exists and is not a folder, FileError when it cannot be made
void make_folder(const std::string& folder);

/// The files of a result, those that it may lack as well.
constexpr const char* kResultFiles[] = {"run.json",    "views.csv",  "cloud.ply", "cloud_raw.ply",
                                        "fruits.json", "fruits.csv", "truss.png", "report.html"};

/// Makes the folder ready for a result; with `force` an older one is removed, finished or not. @throws UsageError when
/// it holds one and `force` is off
void prepare_output(const std::string& folder, bool force);

/// The summary of a result on stdout: a table of fruit, or JSON.
void print_summary(const ScanResult& result, const std::string& folder, bool json);

}  // namespace agrisee::cli
