// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of `agrisee`, and what they share. Results go to stdout, progress and errors to stderr.
#pragma once

#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>
#include <agrisee/study/depth_noise.hpp>
#include <agrisee/workcell.hpp>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace agrisee::cli {

/// Exit codes.
constexpr int kSuccess = 0, kUsage = 1, kBadInput = 2, kScanFailed = 3;

/// A command line that can be parsed but asks for something that cannot be done.
struct UsageError : Error {
  using Error::Error;
};

/// Each of these adds a subcommand. When the user chooses it, `run` is set to a function that does the work and returns
/// the exit code.
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

/// Values of --preset.
std::vector<std::string> preset_choices();
/// Values of --planner: kPlannerNames and `greedy`, which knows the truth and is therefore no planner of the pipeline.
std::vector<std::string> planner_choices();

/// Options that scan and process have in common.
struct CommonOptions {
  std::string preset = "default";
  std::string parameter_file;  ///< value of --params
  std::string output;
  std::vector<double> radius;  ///< smallest and largest expected radius of a fruit (m), or empty
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0 = one per core
  bool force = false, json = false;
};
/// Add these options to a subcommand. @return the option that names the output folder
CLI::Option* add_common_options(CLI::App& command, CommonOptions& options);

/// The preset, changed by the parameter file and the expected radii. @throws FileError, UsageError
Parameters parameters_of(const CommonOptions& options);
/// The number of threads to use: `requested`, or one per core if it is 0.
int threads_of(int requested);
/// The noise model of an option. @throws UsageError for any other text
study::NoiseModel noise_of(const std::string& text);

/// Check whether a scan can start, before anything is written. @throws ParameterError, InputError
void check_scan(const Workcell& workcell, const Parameters& parameters);

/// Create a folder. @throws UsageError if it exists and is not a folder, FileError if it cannot be created
void make_folder(const std::string& folder);

/// The files of a result, those that a result can lack included.
constexpr const char* kResultFiles[] = {"run.json",    "views.csv",  "cloud.ply", "cloud_raw.ply",
                                        "fruits.json", "fruits.csv", "truss.png", "report.html"};

/// Prepare a folder for a new result. With `force`, an older result is removed, whether it is finished or not.
/// @throws UsageError if the folder holds a result and `force` is off
void prepare_output(const std::string& folder, bool force);

/// Print the summary of a result to stdout: a table of the fruit, or JSON.
void print_summary(const ScanResult& result, const std::string& folder, bool json);

}  // namespace agrisee::cli
