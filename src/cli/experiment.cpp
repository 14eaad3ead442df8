// SPDX-License-Identifier: BSD-3-Clause
// agrisee experiment: the experiment of the paper [1], and a report that compares the results with the paper's tables.
#include <agrisee/core/parallel.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/version.hpp>

#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "commands.hpp"
#include "experiment_cells.hpp"
#include "interrupt.hpp"
#include "report/experiment_report.hpp"
#include "report/records.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

/// Read a record. None if it is missing, damaged, or does not belong to what would be run now.
/// @param others if given, counts the records that belong to something else
template <typename Record, typename Read>
std::optional<Record> finished(const fs::path& path, const std::string& fingerprint, Read&& read,
                               std::size_t* others = nullptr) {
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  try {
    Record record = read(path);
    if (record.fingerprint == fingerprint) return record;
    if (others) ++*others;
  } catch (const FileError&) {  // a damaged record counts as missing
  }
  return std::nullopt;
}

std::string duration(double seconds) {
  const auto s = static_cast<long>(std::ceil(seconds));
  return s < 90 ? std::to_string(s) + " s" : std::to_string((s + 30) / 60) + " min";
}

/// One line about a finished cell.
std::string outcome_of(const study::CellRecord& record) {
  std::ostringstream text;
  text << record.metrics.n_true << "/" << record.metrics.n_real << " fruit, "
       << record.metrics.n_det - record.metrics.n_true << " false, " << record.views << " views, recall " << std::fixed
       << std::setprecision(1) << 100.0 * record.metrics.recall_obs << " %, " << record.seconds.total << " s";
  return text.str();
}

/// Run a cell and write its record. @return one line about it, or why it failed
std::string run_and_record(CellJob& job, SceneJob& scene, study::JudgedAfterViews judged) {
  try {
    study::CellRecord record = study::run_cell(scene.subject(), job.cell, job.parameters, 1, judged);
    record.fingerprint = job.fingerprint;
    report::write_record(job.path, record);
    const std::string outcome = outcome_of(record);
    job.record = std::move(record);
    return outcome;
  } catch (const std::exception& e) {
    return std::string("failed: ") + e.what();
  }
}

/// Run the cells that have no record yet. @return messages of the cells that failed
std::vector<std::string> run_cells(std::vector<CellJob>& cells, std::vector<SceneJob>& scenes,
                                   study::JudgedAfterViews judged, int threads) {
  std::vector<std::size_t> open;
  std::size_t replaced = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].record =
        finished<study::CellRecord>(cells[i].path, cells[i].fingerprint, report::read_cell_record, &replaced);
    if (!cells[i].record) open.push_back(i);
  }
  const StopMessage message("agrisee: stopped; the same command goes on: scans with a record are not run again");
  std::cerr << cells.size() << " scans, " << open.size() << " of them to run\n";
  if (replaced > 0)
    std::cerr << "agrisee: " << replaced << " scans have a record of other parameters (--params, --max-views, "
              << "--scanned-only), of another scene or version; the record is replaced\n";
  const auto start = std::chrono::steady_clock::now();
  std::mutex mutex;
  std::size_t done = 0;
  std::vector<std::string> failed;
  parallel_for(
      open.size(), threads,
      [&](std::size_t k) {
        CellJob& job = cells[open[k]];
        const std::string outcome = run_and_record(job, scenes[job.scene], judged);
        const std::lock_guard<std::mutex> lock(mutex);
        ++done;
        if (!job.record) failed.push_back(job.cell.name() + " " + outcome);
        const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        std::cerr << "[" << done << "/" << open.size() << "] " << job.cell.name() << ": " << outcome;
        if (done < open.size())
          std::cerr << "; " << duration(spent / static_cast<double>(done) * static_cast<double>(open.size() - done))
                    << " left";
        std::cerr << "\n";
      },
      1);
  return failed;
}

/// What can be seen of each scene; computed once, then read from its record.
std::vector<study::SceneRecord> judge_scenes(const ExperimentOptions& options, std::vector<SceneJob>& scenes,
                                             int threads) {
  std::vector<study::SceneRecord> records(scenes.size());
  parallel_for(
      scenes.size(), threads,
      [&](std::size_t s) {
        const fs::path path = fs::path(options.output) / "cells" / (study::file_name(scenes[s].name) + ".json");
        if (auto record = finished<study::SceneRecord>(path, scenes[s].fingerprint, report::read_scene_record)) {
          records[s] = *record;
          return;
        }
        records[s] = study::judge_scene(scenes[s].subject());
        report::write_record(path, records[s]);
      },
      1);
  return records;
}

/// The command that repeats the experiment.
std::string command_of(const ExperimentOptions& options) {
  std::string text = "agrisee experiment -o DIR";
  const auto list = [&](const char* option, const std::vector<std::string>& values) {
    if (values.empty()) return;
    text += std::string(" ") + option + " ";
    for (std::size_t i = 0; i < values.size(); ++i) text += (i ? "," : "") + values[i];
  };
  list("--groups", options.groups);
  if (options.groups.empty()) {
    list("--presets", options.presets);
    list("--planner", options.planners);
    list("--noise", options.noises);
  }
  text += " --trials " + std::to_string(options.trials);
  if (options.paper_trials > 0) text += " --paper-trials " + std::to_string(options.paper_trials);
  list("--scenes", options.scenes);
  if (!options.parameter_file.empty()) text += " --params " + options.parameter_file;
  if (options.max_views > 0) text += " --max-views " + std::to_string(options.max_views);
  if (options.scanned_only) text += " --scanned-only";
  return text;
}

int run_experiment(const ExperimentOptions& options) {
  for (const std::string& noise : options.noises) noise_of(noise);
  make_folder(options.output);
  make_folder((fs::path(options.output) / "cells").string());
  const int threads = threads_of(options.threads);
  std::vector<SceneJob> scenes = open_scenes(options);
  std::vector<CellJob> cells = list_cells(options, scenes);
  const std::vector<std::string> failed = run_cells(
      cells, scenes, options.scanned_only ? study::JudgedAfterViews::scanned : study::JudgedAfterViews::all, threads);
  const std::vector<study::SceneRecord> scene_records = judge_scenes(options, scenes, threads);
  std::vector<study::CellRecord> records;
  for (CellJob& job : cells)
    if (job.record) records.push_back(std::move(*job.record));
  if (!records.empty()) {
    const fs::path path = options.report.empty() ? fs::path(options.output) / "report.md" : fs::path(options.report);
    report::write_experiment_report(path, records, scene_records,
                                    {AGRISEE_VERSION, command_of(options), options.groups.empty()});
    std::cout << "Report: " << path.string() << "\n";
  }
  if (failed.empty()) return kSuccess;
  for (const std::string& message : failed) std::cerr << "agrisee: " << message << "\n";
  return kScanFailed;
}

}  // namespace

void add_experiment(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("experiment",
                                     "run the paper's experiment: scenes, presets, planners, noise models and trials");
  auto options = std::make_shared<ExperimentOptions>();
  command
      ->add_option("-o,--output", options->output,
                   "folder for the records; scans that have a record there are not run again")
      ->required();
  command->add_option("--presets", options->presets, "presets to compare")
      ->delimiter(',')
      ->check(one_of(preset_choices()))
      ->capture_default_str();
  command->add_option("--planner", options->planners, "planners (default: that of each preset)")
      ->delimiter(',')
      ->check(one_of(planner_choices()));
  command->add_option("--noise", options->noises, std::string("noise models: ") + study::kNoiseNames)
      ->delimiter(',')
      ->capture_default_str();
  auto* groups = command->add_option(
      "--groups", options->groups,
      "groups to run instead of all combinations of --presets, --planner and --noise: PRESET/PLANNER/NOISE, or "
      "PRESET/PLANNER/NOISE/free for a free-flying camera instead of the arm; the report then compares groups, "
      "without a row per truss");
  groups->delimiter(',');
  for (const char* replaced : {"--presets", "--planner", "--noise"}) groups->excludes(replaced);
  command->add_flag("--scanned-only", options->scanned_only,
                    "after each view measure only how much surface was scanned, not the fruit; much faster");
  command->add_option("--trials", options->trials, "number of trials; the seeds are 1, 2, ...")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--paper-trials", options->paper_trials,
                   "number of trials of the paper preset, which takes longer (default: the same as --trials)")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--scenes", options->scenes,
                   "scene files, or trusses by name (7_1, or 7_1_s5 for seed 5); default: the eleven of paper-scenes")
      ->delimiter(',');
  command->add_option("--params", options->parameter_file, "YAML file with parameters to change in every preset");
  command->add_option("--max-views", options->max_views, "largest number of views (default: that of the preset)")
      ->check(CLI::Range(1, 10000));
  command->add_option("--threads", options->threads, "number of scans at a time (0: one per core)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--report", options->report, "Markdown file to write (default: report.md in the folder)");
  command->footer(
      "Examples:\n"
      "  agrisee experiment -o build/experiment\n"
      "  agrisee experiment -o small --scenes 7_1,8_4 --presets default --noise none,rough --trials 1\n"
      "  agrisee experiment -o planners --presets default --planner gain,see,fixed,random,greedy\n"
      "Scans run in parallel, each on one thread. `agrisee scan DIR/scenes/NAME/scene.yaml --seed TRIAL` repeats one.");
  command->callback([options, &run] { run = [options] { return run_experiment(*options); }; });
}

}  // namespace agrisee::cli
