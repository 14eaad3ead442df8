// SPDX-License-Identifier: BSD-3-Clause
// agrisee experiment: the paper's experiment, side by side with its tables.
#include <agrisee/io/experiment.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/fingerprint.hpp>
#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/report.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/version.hpp>

#include <chrono>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>

#include "commands.hpp"
#include "simulate.hpp"
#include "trusses.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

struct ExperimentOptions {
  std::string output, report, params;
  std::vector<std::string> presets{"paper", "default"}, planners, noises{"l515"}, scenes;
  int trials = 3, paper_trials = 0, threads = 0, max_views = 0;

  int trials_of(const std::string& preset) const {
    return preset == "paper" && paper_trials > 0 ? paper_trials : trials;
  }
};

/// A scene of the experiment; what is costly of it is made when its first cell runs.
struct SceneJob {
  std::string name;
  fs::path path;  ///< of scene.yaml
  io::SceneFile file;
  std::string fingerprint;
  std::unique_ptr<std::once_flag> once = std::make_unique<std::once_flag>();
  std::shared_ptr<const study::Subject> subject;

  const study::Subject& ready() {
    std::call_once(*once, [&] {
      const auto known = io::read_ground_truth(path.parent_path() / "ground_truth.json");
      subject = cli::make_subject(name, fingerprint, file.scene, file.workcell, known);
    });
    return *subject;
  }
};

SceneJob open_scene(const fs::path& path) {
  SceneJob job;
  job.path = path;
  job.file = io::read_scene(path);
  job.name = job.file.workcell.name;
  io::Fingerprint print;
  print.add(AGRISEE_VERSION);
  print.add(io::read_bytes(path).view());
  const fs::path truth = path.parent_path() / "ground_truth.json";
  if (fs::exists(truth)) print.add(io::read_bytes(truth).view());
  print.add(job.file.scene);
  job.fingerprint = print.text();
  return job;
}

/// Scenes by name are made anew, so that they are those of this version; others are read from their files.
std::vector<SceneJob> open_scenes(const ExperimentOptions& options) {
  std::vector<SceneJob> jobs;
  std::set<std::string> names;
  for (const std::string& text : options.scenes.empty() ? paper_truss_names() : options.scenes) {
    if (const auto truss = truss_by_name(text)) {
      const fs::path folder = fs::path(options.output) / "scenes" / truss->workcell.name;
      make_folder(folder.string());
      write_truss(folder, *truss);
      jobs.push_back(open_scene(folder / "scene.yaml"));
    } else {
      jobs.push_back(open_scene(text));
    }
    if (!names.insert(jobs.back().name).second)
      throw UsageError(text + ": a second scene of the name " + jobs.back().name);
  }
  return jobs;
}

struct CellJob {
  study::Cell cell;
  std::size_t scene = 0;
  Parameters parameters;
  std::string fingerprint;
  fs::path path;
  std::optional<study::CellRecord> record;
};

std::vector<CellJob> list_cells(const ExperimentOptions& options, const std::vector<SceneJob>& scenes) {
  std::vector<CellJob> jobs;
  std::set<std::string> names;
  for (std::size_t s = 0; s < scenes.size(); ++s)
    for (const std::string& preset : options.presets) {
      Parameters parameters = Parameters::named(preset);
      if (!options.params.empty()) parameters = io::read_parameters(options.params, parameters);
      if (options.max_views > 0) parameters.max_views = options.max_views;
      const std::vector<std::string> own{parameters.planner};
      for (const std::string& planner : options.planners.empty() ? own : options.planners)
        for (const std::string& noise : options.noises)
          for (int trial = 1; trial <= options.trials_of(preset); ++trial) {
            CellJob job;
            job.cell = {scenes[s].name, preset, planner, sensor::to_string(sensor::parse_noise(noise)), trial};
            if (!names.insert(job.cell.name()).second) continue;
            job.scene = s;
            job.parameters = parameters;
            io::Fingerprint print;
            print.add(scenes[s].fingerprint);
            print.add(io::parameters_to_json(parameters));
            job.fingerprint = print.text();
            job.path = fs::path(options.output) / "cells" / (job.cell.name() + ".json");
            jobs.push_back(std::move(job));
          }
    }
  return jobs;
}

/// A record that is there, readable and of what would be run now.
template <typename Record, typename Read>
std::optional<Record> finished(const fs::path& path, const std::string& fingerprint, Read&& read) {
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  try {
    Record record = read(path);
    if (record.fingerprint == fingerprint) return record;
  } catch (const FileError&) {  // half a record is none
  }
  return std::nullopt;
}

std::string duration(double seconds) {
  const auto s = static_cast<long>(std::ceil(seconds));
  return s < 90 ? std::to_string(s) + " s" : std::to_string((s + 30) / 60) + " min";
}

/// Runs what is not finished. @return messages of cells that failed
std::vector<std::string> run_cells(std::vector<CellJob>& cells, std::vector<SceneJob>& scenes, int threads) {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].record = finished<study::CellRecord>(cells[i].path, cells[i].fingerprint, io::read_cell_record);
    if (!cells[i].record) open.push_back(i);
  }
  std::cerr << cells.size() << " cells, " << open.size() << " of them to run\n";
  const auto start = std::chrono::steady_clock::now();
  std::mutex mutex;
  std::size_t done = 0;
  std::vector<std::string> failed;
  parallel_for(
      open.size(), threads,
      [&](std::size_t k) {
        CellJob& job = cells[open[k]];
        std::string outcome;
        try {
          study::CellRecord record = cli::run_cell(scenes[job.scene].ready(), job.cell, job.parameters);
          record.fingerprint = job.fingerprint;
          io::write_record(job.path, record);
          std::ostringstream text;
          text << record.metrics.n_true << "/" << record.metrics.n_real << " fruit, "
               << record.metrics.n_det - record.metrics.n_true << " false, " << record.views << " views, recall "
               << std::fixed << std::setprecision(1) << 100.0 * record.metrics.recall_obs << " %, "
               << record.seconds.total << " s";
          outcome = text.str();
          job.record = std::move(record);
        } catch (const std::exception& e) {
          outcome = std::string("failed: ") + e.what();
        }
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

/// What can be seen of each scene, measured once.
std::vector<study::SceneRecord> judge_scenes(const ExperimentOptions& options, std::vector<SceneJob>& scenes,
                                             int threads) {
  std::vector<study::SceneRecord> records(scenes.size());
  parallel_for(
      scenes.size(), threads,
      [&](std::size_t s) {
        const fs::path path = fs::path(options.output) / "cells" / (study::file_name(scenes[s].name) + ".json");
        if (auto record = finished<study::SceneRecord>(path, scenes[s].fingerprint, io::read_scene_record)) {
          records[s] = *record;
          return;
        }
        records[s] = cli::judge_scene(scenes[s].ready());
        io::write_record(path, records[s]);
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
  list("--presets", options.presets);
  list("--planner", options.planners);
  list("--noise", options.noises);
  text += " --trials " + std::to_string(options.trials);
  if (options.paper_trials > 0) text += " --paper-trials " + std::to_string(options.paper_trials);
  list("--scenes", options.scenes);
  if (!options.params.empty()) text += " --params " + options.params;
  if (options.max_views > 0) text += " --max-views " + std::to_string(options.max_views);
  return text;
}

int run_experiment(const ExperimentOptions& options) {
  for (const std::string& noise : options.noises) {
    try {
      sensor::parse_noise(noise);
    } catch (const ParameterError& e) {
      throw UsageError(e.what());
    }
  }
  make_folder(options.output);
  make_folder((fs::path(options.output) / "cells").string());
  const int threads = threads_of(options.threads);
  std::vector<SceneJob> scenes = open_scenes(options);
  std::vector<CellJob> cells = list_cells(options, scenes);
  const std::vector<std::string> failed = run_cells(cells, scenes, threads);
  const std::vector<study::SceneRecord> scene_records = judge_scenes(options, scenes, threads);
  std::vector<study::CellRecord> records;
  for (CellJob& job : cells)
    if (job.record) records.push_back(std::move(*job.record));
  if (!records.empty()) {
    const fs::path report = options.report.empty() ? fs::path(options.output) / "report.md" : fs::path(options.report);
    io::write_report(report, records, scene_records, {AGRISEE_VERSION, command_of(options)});
    std::cout << "Report: " << report.string() << "\n";
  }
  if (failed.empty()) return kSuccess;
  for (const std::string& message : failed) std::cerr << "agrisee: " << message << "\n";
  return kScanFailed;
}

}  // namespace

void add_experiment(CLI::App& app, Run& run) {
  auto* command =
      app.add_subcommand("experiment", "the paper's experiment: scenes, presets, planners, noises and trials, tabled");
  auto options = std::make_shared<ExperimentOptions>();
  command->add_option("-o,--output", options->output, "folder; what is finished in it is not run again")->required();
  command->add_option("--presets", options->presets, "paper, default")
      ->delimiter(',')
      ->check(CLI::IsMember({"paper", "default"}))
      ->capture_default_str();
  command->add_option("--planner", options->planners, "planners (default: each preset's own)")
      ->delimiter(',')
      ->check(CLI::IsMember({"gain", "see", "fixed", "random", "greedy"}));
  command->add_option("--noise", options->noises, "noise models: none, gaussian:SIGMA, l515, rough")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--trials", options->trials, "trials; their numbers are the seeds")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--paper-trials", options->paper_trials,
                   "trials of the paper preset, which takes longer (default: as many as of others)")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--scenes", options->scenes,
                   "scene files, trusses of the paper (7_1) or of other seeds (7_1_s5); default: the paper's eleven")
      ->delimiter(',');
  command->add_option("--params", options->params, "YAML file with parameters to change in every preset");
  command->add_option("--max-views", options->max_views, "view budget (default: the preset's)")
      ->check(CLI::Range(1, 10000));
  command->add_option("--threads", options->threads, "cells at a time (0: as many as cores)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--report", options->report, "Markdown file to write (default: report.md in the folder)");
  command->footer(
      "Examples:\n"
      "  agrisee experiment -o build/experiment\n"
      "  agrisee experiment -o small --scenes 7_1,8_4 --presets default --noise none,rough --trials 1\n"
      "  agrisee experiment -o planners --presets default --planner gain,see,fixed,random,greedy\n"
      "Cells run side by side, each on one thread; `agrisee scan DIR/scenes/NAME/scene.yaml --seed TRIAL` repeats "
      "one.");
  command->callback([options, &run] { run = [options] { return run_experiment(*options); }; });
}

}  // namespace agrisee::cli
