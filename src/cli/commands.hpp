// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of `agrisee`, and what they share. Results go to stdout, progress and errors to stderr.
#pragma once

#include <agrisee/io/scan_page.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/depth_noise.hpp>
#include <agrisee/workcell.hpp>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace agrisee::cli {

/// Exit codes. kUsage: the command line cannot be followed, whatever its inputs hold. kBadInput: an input is missing or
/// damaged, or contradicts the command line. kScanFailed: a scan failed midway, or could take no view.
constexpr int kSuccess = 0, kUsage = 1, kBadInput = 2, kScanFailed = 3;

/// A command line that can be parsed but asks for something that cannot be done, whatever its inputs hold.
struct UsageError : Error {
  using Error::Error;
};

/// A scan that failed midway, or could take no view; kScanFailed.
struct ScanFailed : Error {
  using Error::Error;
};

/// What an exception says; of one of the file system the path and the reason.
std::string message_of(const std::exception& e);

/// Each of these adds a subcommand. When the user chooses it, `run` is set to a function that does the work and returns
/// the exit code.
using Run = std::function<int()>;
void add_scan(CLI::App& app, Run& run);
void add_process(CLI::App& app, Run& run);
void add_make_truss(CLI::App& app, Run& run);
void add_make_plant(CLI::App& app, Run& run);
void add_evaluate(CLI::App& app, Run& run);
void add_paper_scenes(CLI::App& app, Run& run);
void add_experiment(CLI::App& app, Run& run);
void add_limit(CLI::App& app, Run& run);
void add_merge(CLI::App& app, Run& run);
void add_season(CLI::App& app, Run& run);
void add_faults(CLI::App& app, Run& run);
void add_export_views(CLI::App& app, Run& run);
void add_parameters(CLI::App& app, Run& run);
void add_doctor(CLI::App& app, Run& run);
void add_completion(CLI::App& app, Run& run);
void add_manual(CLI::App& app, Run& run);

/// Values of --preset.
std::vector<std::string> preset_choices();
/// Values of --planner: kPlannerNames and `greedy`, which knows the truth and is therefore no planner of the pipeline.
std::vector<std::string> planner_choices();

/// Options that scan and process have in common.
struct CommonOptions {
  std::string preset = kPresetNames[0];
  bool preset_asked = false;   ///< the command line names it
  std::string parameter_file;  ///< value of --params
  std::string output;
  std::vector<double> radius;  ///< smallest and largest expected radius of a fruit (m), or empty
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0 = one per core
  bool force = false, json = false, quiet = false, no_report = false, no_picture = false;
  bool prepared = false;  ///< a list of inputs has prepared the folder
};
/// Add these options to a subcommand. @return the option that names the output folder
CLI::Option* add_common_options(CLI::App& command, CommonOptions& options);

/// A preset that an option names, changed by a parameter file.
/// @throws UsageError if the file names another preset, FileError
Parameters changed_by(const std::string& file, const Parameters& preset, const char* option);
/// The preset, changed by the parameter file and the expected radii. @throws FileError, UsageError
Parameters parameters_of(const CommonOptions& options);
/// The number of threads to use: `requested`, or one per core if it is 0.
int threads_of(int requested);
/// The noise model of an option. @throws UsageError for any other text
study::NoiseModel noise_of(const std::string& text);

/// Fingerprint of a scene file and its meshes.
std::string content_of(const std::string& scene, const io::SceneFile& file);

/// The colors and masks that a scan simulates.
study::ImageOptions images_of(const io::ScanTask& task);

/// Check whether a scan can start, before anything is written. @throws ParameterError, InputError
void check_scan(const Workcell& workcell, const Parameters& parameters);

/// Create a folder. @throws UsageError if it exists and is not a folder, FileError if it cannot be created
void make_folder(const std::string& folder);

/// Check that a folder can take a new result: that it holds none, or that `force` is on.
/// @throws UsageError, which says how to go on, if it holds a result or an unfinished scan and `force` is off
void check_output(const std::string& folder, bool force);

/// Whether a folder holds all files of a result that the options ask for.
bool is_finished(const std::string& folder, const CommonOptions& options);

/// Prepare a folder for a new result. With `force`, an older result is removed, whether it is finished or not.
/// @throws UsageError as check_output
void prepare_output(const std::string& folder, bool force);

/// Write the files of a result; of the picture and the report those that the options do not leave out.
void write_files(const std::string& folder, const ScanResult& result, const Workcell& workcell, const io::RunInfo& info,
                 const CommonOptions& options, const io::ScanHistory& history = {});

/// Tell on stderr of the view taken last, of at most `budget`: a line, or, on a terminal, a bar drawn over the last
/// one.
void show_progress(const std::vector<View>& views, std::size_t budget);
/// Call after the last view.
void end_progress();

/// Print the summary of a result to stdout: a table of the fruit unless it should be quiet, or JSON, on one
/// line in a list.
void print_summary(const ScanResult& result, const std::string& folder, const CommonOptions& options);

}  // namespace agrisee::cli
