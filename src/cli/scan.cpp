// SPDX-License-Identifier: BSD-3-Clause
// agrisee scan: a simulated scan of a scene file.
#include <agrisee/io/files.hpp>
#include <agrisee/io/fingerprint.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/ply.hpp>
#include <agrisee/io/render.hpp>
#include <agrisee/io/report_html.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/see/density.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/simulated_scan.hpp>
#include <agrisee/version.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <unistd.h>

#include "commands.hpp"
#include "many.hpp"
#include "simulate.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

struct ScanOptions : PipelineOptions {
  std::vector<std::string> scenes;
  std::string shard;
  std::string scene, planner, noise = "none", resume;
  int max_views = 0;
};

/// One line a view; on a terminal a bar that is drawn over.
void show_progress(const Pipeline& pipeline, int budget) {
  const View& v = pipeline.views().back();
  const auto n = static_cast<int>(pipeline.views().size());
  std::string line = "view " + std::to_string(n) + "/" + std::to_string(budget) + ": " + std::to_string(v.points_in) +
                     " points seen, " + std::to_string(v.points_new) + " new";
  if (isatty(STDERR_FILENO)) {
    const int width = 24, done = std::min(width, width * n / std::max(1, budget));
    std::cerr << "\r[" << std::string(static_cast<std::size_t>(done), '#')
              << std::string(static_cast<std::size_t>(width - done), '.') << "] " << line << "\033[K" << std::flush;
  } else {
    std::cerr << line << "\n";
  }
}

/// Follows a scan for its report: what the planner believes to have seen, what was seen in truth, and SEE++'s frontier.
class Recorder {
 public:
  Recorder(const Scene& scene, const Parameters& parameters, int threads) : parameters_(parameters), threads_(threads) {
    try {
      samples_ = study::fruit_samples(scene);
    } catch (const InputError&) {  // fruit without a surface can be scanned, but not be told of
    }
  }
  /// After every view. What a planner tells is as of before the view.
  void observe(const Pipeline& pipeline, const Cloud& raw) {
    if (!scanned_.empty()) believe(pipeline.completeness());
    const double near = study::MetricParameters().threshold;
    const study::Flags covered = study::detail::cover(samples_, raw.points, near, threads_).covered;
    scanned_.push_back(static_cast<double>(std::count(covered.begin(), covered.end(), 1)) /
                       static_cast<double>(std::max<std::size_t>(covered.size(), 1)));
    merged_ = pipeline.merged();
  }
  /// What a report shows of the scan that ended with this result.
  io::ScanHistory history(const ScanResult& result) {
    io::ScanHistory history;
    // After a last view that the budget ended no belief was formed.
    if (!scanned_.empty()) believe(result.stop_reason == StopReason::max_views ? std::nullopt : result.completeness);
    const auto told = [](double value) { return std::isfinite(value); };
    if (std::any_of(seen_.begin(), seen_.end(), told))
      history.curves = {{"seen, as the planner believes", seen_}, {"within the arm's sight", observable_}};
    if (samples_.size() > 0 && !scanned_.empty()) history.curves.push_back({"seen in truth", scanned_});
    if (parameters_.planner != "see" || result.views.empty()) return history;
    see::DensityMap<float> map(parameters_.see, 0.0);
    map.insert(merged_, 0, threads_);
    for (const Index i : map.of_class(see::PointClass::frontier))
      history.frontier.push_back(map.cloud().points[static_cast<std::size_t>(i)]);
    return history;
  }

 private:
  void believe(const std::optional<Completeness>& completeness) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    seen_.push_back(completeness ? completeness->seen : kUnknown);
    observable_.push_back(completeness ? completeness->observable : kUnknown);
  }

  Parameters parameters_;
  int threads_;
  study::Samples samples_;
  std::vector<double> seen_, observable_, scanned_;
  Cloud merged_;
};

/// What the command line asks for; the scene's content is not known yet.
io::ScanTask task_of(const ScanOptions& options) {
  io::ScanTask task;
  task.parameters = parameters_of(options);
  const bool greedy = options.planner == "greedy";  // it needs the scene's truth, so it is no parameter
  if (!options.planner.empty() && !greedy) task.parameters.planner = options.planner;
  if (options.max_views > 0) task.parameters.max_views = options.max_views;
  task.parameters.check();
  task.planner = greedy ? options.planner : task.parameters.planner;
  task.scene = fs::absolute(options.scene).lexically_normal().string();
  task.version = AGRISEE_VERSION;
  task.seed = options.seed;
  task.threads = threads_of(options.threads);
  task.noise = options.noise;
  try {
    sensor::parse_noise(options.noise);
  } catch (const ParameterError& e) {
    throw UsageError(e.what());
  }
  return task;
}

/// What a scan that was interrupted was asked for. @throws FileError when there is none that this program can go on
/// with
io::ScanTask task_to_resume(const ScanOptions& options, const fs::path& path) {
  if (!fs::exists(path)) throw FileError(path.string() + ": no such file, so there is no scan to go on with");
  io::ScanTask task = io::read_scan_task(path);
  if (task.version != AGRISEE_VERSION)
    throw FileError(path.string() + ": the scan was begun by version " + task.version + ", this is " AGRISEE_VERSION);
  if (!options.scene.empty()) task.scene = fs::absolute(options.scene).lexically_normal().string();
  if (options.threads > 0) task.threads = options.threads;
  return task;
}

std::string content_of(const std::string& scene, const io::SceneFile& file) {
  io::Fingerprint print;
  print.add(io::read_bytes(scene).view());
  print.add(file.scene);
  return print.text();
}

/// Keeps a record of every view that is taken, and gives those that are recorded already as they were.
study::Look recorded(study::Look look, const fs::path& folder, const std::string& scan, std::size_t pixels) {
  return [look = std::move(look), folder, scan, pixels](const plan::ReachableView& view,
                                                        std::size_t number) -> std::optional<sensor::Capture> {
    if (const auto record = io::read_view_record(folder, number, scan, pixels)) {
      if (record->world_T_optical_asked.matrix() != view.world_T_optical.matrix() || record->joints != view.joints)
        throw FileError(io::view_record_path(folder, number).string() + ": was taken from elsewhere than is planned");
      return sensor::Capture{record->frame, record->world_T_optical};
    }
    auto capture = look(view, number);
    if (capture)
      io::write_view_record(folder, number,
                            {capture->frame, view.world_T_optical, capture->world_T_optical, view.joints}, scan);
    return capture;
  };
}

bool is_finished(const fs::path& folder) {
  return std::all_of(std::begin(kResultFiles), std::end(kResultFiles),
                     [&](const char* name) { return fs::exists(folder / name); });
}

int run_scan(const ScanOptions& options) {
  const bool resuming = !options.resume.empty();
  const fs::path folder = resuming ? options.resume : options.output;
  io::ScanTask task = resuming ? task_to_resume(options, folder / "scan.json") : task_of(options);
  const Parameters& parameters = task.parameters;
  study::SimulationOptions simulation;
  simulation.noise = sensor::parse_noise(task.noise);
  simulation.seed = task.seed;
  simulation.threads = task.threads;
  const io::SceneFile file = io::read_scene(task.scene);
  const std::string content = content_of(task.scene, file);
  if (resuming && content != task.content)
    throw FileError(task.scene + ": is not the scene any more that the scan in " + folder.string() + " began with");
  task.content = content;
  const TracedScene traced(file.scene, task.threads);
  cli::check_scan(file.workcell, parameters);  // what cannot be scanned is refused before anything is written
  if (task.planner == "greedy") {
    const study::Samples samples = study::fruit_samples(file.scene);
    if (samples.size() == 0) throw FileError(task.scene + ": holds no fruit, whose truth the greedy planner needs");
    simulation.planner = cli::make_greedy_planner(traced, samples, file.workcell, simulation.threads);
  }
  if (!resuming) {
    prepare_output(folder.string(), options.force);
    io::write_scan_task(folder / "scan.json", task);
  } else if (is_finished(folder)) {
    std::cerr << folder.string() << ": the scan is finished, nothing is left to do\n";
    return kSuccess;
  } else {
    io::remove_leftovers(folder);
    io::remove_leftovers(folder / "views");
  }

  const std::string scan = task.fingerprint();
  simulation.around = [&](study::Look look) {
    return recorded(std::move(look), folder, scan, file.workcell.sensor.intrinsics.size());
  };
  Recorder recorder(file.scene, parameters, simulation.threads);
  std::size_t taken = 0;
  simulation.on_view = [&](const Pipeline& pipeline) {
    const Cloud raw = pipeline.raw();
    taken = pipeline.views().size();
    // What is rebuilt from records is not written anew: the files tell of more views than that.
    if (!fs::exists(io::view_record_path(folder, taken))) {
      io::write_views(folder / "views.csv", pipeline.views());
      io::write_raw_ply(folder / "cloud_raw.ply", raw);
    }
    recorder.observe(pipeline, raw);
    show_progress(pipeline, parameters.max_views);
  };
  ScanResult result;
  try {
    result = cli::scan(file.workcell, traced, parameters, std::move(simulation));
    if (isatty(STDERR_FILENO)) std::cerr << "\n";
    io::RunInfo info;
    info.scene = file.workcell.name;
    info.version = task.version;
    info.seed = task.seed;
    info.threads = task.threads;
    info.noise = task.noise;
    info.preset = parameters.preset;
    info.planner = task.planner;
    info.parameters_json = io::parameters_to_json(parameters);
    io::write_result(folder, result, file.workcell, info);
    io::write_picture(folder / "truss.png", result, file.workcell);
    io::write_report_html(folder / "report.html", result, file.workcell, info, recorder.history(result));
  } catch (const std::exception& e) {
    std::cerr << "\nagrisee: the scan failed midway: " << e.what() << "\n";
    if (taken > 0)
      std::cerr << "The views taken so far are in " << (folder / "views").string() << "; `agrisee scan --resume "
                << folder.string() << "` goes on from there\n";
    return kScanFailed;
  }
  print_summary(result, folder.string(), options.json);
  if (result.views.empty()) {
    std::cerr << "agrisee: no view could be taken (" << to_string(result.stop_reason)
              << "): the scan volume is out of the arm's reach\n";
    return kScanFailed;
  }
  return kSuccess;
}

}  // namespace

void add_scan(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("scan", "scan a scene with the simulated sensor and arm, and locate its fruit");
  auto options = std::make_shared<ScanOptions>();
  auto* scene = command->add_option("scene", options->scenes,
                                    "scene file (YAML); several, or a pattern, each get a folder of their own in DIR");
  auto* output = add_pipeline_options(*command, *options);
  command->add_option("--planner", options->planner, "where to look next; greedy knows the truth, for studies")
      ->check(CLI::IsMember({"gain", "see", "fixed", "random", "greedy"}));
  command->add_option("--noise", options->noise, "noise of the sensor: none, gaussian:SIGMA, l515 or rough")
      ->capture_default_str();
  command->add_option("--max-views", options->max_views, "view budget (default: the preset's)")
      ->check(CLI::Range(1, 10000));
  add_shard_option(*command, options->shard);
  auto* resume = command->add_option(
      "--resume", options->resume,
      "go on with the scan in this folder that was interrupted; the scene is only named when it was moved");
  for (const char* given : {"--output", "--preset", "--params", "--radius", "--seed", "--force", "--planner", "--noise",
                            "--max-views", "--shard"})
    resume->excludes(given);  // all of them are as they were
  command->footer(
      "Examples:\n"
      "  agrisee scan truss/scene.yaml -o result --noise l515 --seed 1\n"
      "  agrisee scan truss/scene.yaml -o paper --preset paper --noise gaussian:0.002 --max-views 20\n"
      "  agrisee scan cherries/scene.yaml -o result --radius 0.01,0.02\n"
      "  agrisee scan --resume result\n"
      "  agrisee scan 'season/*/scene.yaml' -o results --shard 2/8\n"
      "DIR holds cloud.ply, cloud_raw.ply, views.csv, fruits.json, fruits.csv, run.json, truss.png and report.html,\n"
      "and what a scan that is killed goes on from: scan.json and views/, a file a view.");
  command->callback([options, scene, output, resume, &run] {
    if (resume->count() == 0)
      for (const CLI::Option* needed : {scene, output})
        if (needed->count() == 0) throw CLI::RequiredError(needed->get_name());
    if (resume->count() > 0 && options->scenes.size() > 1)
      throw CLI::ValidationError("--resume", "goes on with one scan, so at most one scene can be named");
    run = [options] {
      return run_inputs(options->scenes, options->shard, options->output,
                        [&](const std::string& input, const std::string& folder) {
                          ScanOptions one = *options;
                          one.scene = input;
                          one.output = folder;
                          return run_scan(one);
                        });
    };
  });
}

}  // namespace agrisee::cli
