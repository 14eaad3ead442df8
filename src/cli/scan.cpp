// SPDX-License-Identifier: BSD-3-Clause
// agrisee scan: simulates the scan of a scene file.
#include <agrisee/io/files.hpp>
#include <agrisee/io/fingerprint.hpp>
#include <agrisee/io/mcap.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/ply.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/greedy_planner.hpp>
#include <agrisee/study/samples.hpp>
#include <agrisee/study/simulated_scan.hpp>
#include <agrisee/version.hpp>

#include <filesystem>
#include <iostream>
#include <memory>

#include "commands.hpp"
#include "folder_lock.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "many.hpp"
#include "scan_history.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

struct ScanOptions : CommonOptions {
  std::vector<std::string> scenes;
  std::string shard;
  std::string scene, planner, noise = "none", light, detector, resume, mcap;
  bool live = false, color = false;
  int max_views = 0;
};

/// The task that the command line asks for, still without the fingerprint of the scene. @throws UsageError, FileError
io::ScanTask task_of(const ScanOptions& options) {
  io::ScanTask task;
  task.parameters = parameters_of(options);
  const bool greedy = options.planner == "greedy";  // it needs the truth of the scene, so it is not a parameter
  if (!options.planner.empty() && !greedy) task.parameters.planner = options.planner;
  if (options.max_views > 0) task.parameters.max_views = options.max_views;
  task.parameters.check();
  task.planner = greedy ? options.planner : task.parameters.planner;
  task.scene = fs::absolute(options.scene).lexically_normal().string();
  task.version = AGRISEE_VERSION;
  task.seed = options.seed;
  task.threads = threads_of(options.threads);
  if (!options.light.empty() && options.noise == "none") throw UsageError("--light needs --noise l515, azure or d405");
  task.noise = to_string(noise_of(options.light.empty() ? options.noise : options.noise + ":" + options.light));
  task.color = options.color || !options.detector.empty();
  task.detector = options.detector;
  return task;
}

/// The task of a scan that was interrupted. @throws FileError if there is none, or it was started by another version
io::ScanTask task_to_resume(const ScanOptions& options, const fs::path& path) {
  if (!fs::exists(path)) throw FileError(path.string() + ": no such file, so there is no scan to resume");
  io::ScanTask task = io::read_scan_task(path);
  if (task.version != AGRISEE_VERSION)
    throw FileError(path.string() + ": the scan was started by version " + task.version +
                    ", but this is version " AGRISEE_VERSION);
  if (!options.scene.empty()) task.scene = fs::absolute(options.scene).lexically_normal().string();
  if (options.threads > 0) task.threads = options.threads;
  return task;
}

/// Fingerprint of all that changes the result of a scan: version, scene, parameters, noise, seed.
std::string key_of(const ScanOptions& options, const std::string& scene) {
  ScanOptions one = options;
  one.scene = scene;
  const io::ScanTask task = task_of(one);
  io::Fingerprint print;
  for (const std::string& text : {std::string("scan"), task.version, content_of(scene, io::read_scene(scene)),
                                  task.noise, task.planner, task.detector, std::string(task.color ? "color" : ""),
                                  std::to_string(task.seed), io::parameters_to_json(task.parameters)})
    print.add(text + "\n");
  return print.text();
}

/// Wrap what takes views: each view that is taken is recorded, and a view that has a record is read from it.
study::ViewTaker recorded(study::ViewTaker take_view, const fs::path& folder, const std::string& scan,
                          std::size_t pixels) {
  return [take_view = std::move(take_view), folder, scan, pixels](const plan::ReachableView& view,
                                                                  std::size_t number) -> std::optional<study::Capture> {
    if (const auto record = io::read_view_record(folder, number, scan, pixels)) {
      if (record->world_T_optical_asked.matrix() != view.world_T_optical.matrix() || record->joints != view.joints)
        throw FileError(io::view_record_path(folder, number).string() + ": was not taken from where the planner asks");
      return study::Capture{record->frame, record->world_T_optical};
    }
    auto capture = take_view(view, number);
    if (capture)
      io::write_view_record(folder, number,
                            {capture->frame, view.world_T_optical, capture->world_T_optical, view.joints}, scan);
    return capture;
  };
}

/// Wrap what takes views: the recorder gets each frame.
study::ViewTaker observed(study::ViewTaker take_view, HistoryRecorder& recorder) {
  return [take_view = std::move(take_view), &recorder](const plan::ReachableView& view, std::size_t number) {
    auto capture = take_view(view, number);
    if (capture) recorder.take(number, capture->frame);
    return capture;
  };
}

/// The planner `greedy`; null for the planners that the pipeline makes. @throws FileError if the scene has no fruit
std::unique_ptr<plan::Planner> study_planner(const io::ScanTask& task, const io::SceneFile& file,
                                             const study::TracedScene& traced) {
  if (task.planner != "greedy") return nullptr;
  const study::Samples samples = study::fruit_samples(file.scene);
  if (samples.size() == 0) throw FileError(task.scene + ": holds no fruit, which the greedy planner needs to know");
  return study::make_greedy_planner(traced, samples, file.workcell, {}, task.threads);
}

io::RunInfo run_info(const io::ScanTask& task, const Workcell& workcell) {
  io::RunInfo info;
  info.scene = workcell.name;
  info.version = task.version;
  info.time = io::utc_now();
  info.seed = task.seed;
  info.threads = task.threads;
  info.noise = task.noise;
  info.detector = task.detector;
  info.preset = task.parameters.preset;
  info.planner = task.planner;
  info.parameters_json = io::parameters_to_json(task.parameters);
  return info;
}

/// Run a scan whose folder is prepared, and write its result. @throws ScanFailed
void run_task(const fs::path& folder, const io::ScanTask& task, const io::SceneFile& file,
              const study::TracedScene& traced, std::unique_ptr<plan::Planner> planner, const ScanOptions& options) {
  study::SimulationOptions simulation;
  simulation.noise = study::parse_noise(task.noise);
  simulation.images = images_of(task);
  simulation.seed = task.seed;
  simulation.threads = task.threads;
  simulation.planner = std::move(planner);
  HistoryRecorder recorder(file.scene, task.parameters, task.threads);
  simulation.around = [&](study::ViewTaker take_view) {
    return observed(recorded(std::move(take_view), folder, task.fingerprint(), file.workcell.sensor.intrinsics.size()),
                    recorder);
  };
  std::size_t taken = 0;
  simulation.on_view = [&](const Pipeline& pipeline) {
    const Cloud raw = pipeline.raw();
    taken = pipeline.views().size();
    // While a resumed scan still reads its views from records, the files already hold more views than the pipeline.
    const bool latest = !fs::exists(io::view_record_path(folder, taken));
    if (latest) {
      io::write_views(folder / "views.csv", pipeline.views());
      io::write_raw_ply(folder / "cloud_raw.ply", raw);
    }
    recorder.observe(pipeline, raw);
    if (latest && options.live) {
      const ScanResult so_far = pipeline.result();
      io::ScanHistory history = recorder.history(so_far);
      history.running = true;
      io::write_scan_page(folder / "report.html", so_far, file.workcell, run_info(task, file.workcell), history);
    }
    if (!options.quiet) show_progress(pipeline.views(), static_cast<std::size_t>(task.parameters.max_views));
  };
  const std::string resume = "continue with `agrisee scan --resume " + shell_word(folder.string()) + "`";
  const StopMessage message("agrisee: the scan was interrupted; " + resume);
  ScanResult result;
  try {
    result = study::scan(file.workcell, traced, task.parameters, std::move(simulation));
    result.warnings.insert(result.warnings.begin(), file.warnings.begin(), file.warnings.end());
    if (!options.quiet) end_progress();
    if (!options.mcap.empty())
      io::write_mcap(
          options.mcap, file.workcell,
          [&](std::size_t view) {
            return io::read_view_record(folder, view, task.fingerprint(), file.workcell.sensor.intrinsics.size());
          },
          result);
    write_files(folder.string(), result, file.workcell, run_info(task, file.workcell), options,
                recorder.history(result));
  } catch (const std::exception& e) {
    std::error_code ignored;
    if (!options.quiet && taken > 0) end_progress();
    std::string told = "the scan failed midway: " + message_of(e);
    if (taken > 0)
      told += "; the views taken so far are in " + (folder / "views").string() + ", " + resume;
    else if (options.resume.empty() && !fs::exists(io::view_record_path(folder, 0), ignored))
      fs::remove(folder / "scan.json", ignored);  // there is nothing to resume
    throw ScanFailed(told);
  }
  print_summary(result, folder.string(), options);
  if (result.views.empty())
    throw ScanFailed(std::string("no view could be taken (") + to_string(result.stop_reason) +
                     "): the scan volume is out of the arm's reach, or the arm or its camera would collide; agrisee "
                     "doctor shows which");
}

void run_scan(const ScanOptions& options) {
  const bool resuming = !options.resume.empty();
  const fs::path folder = resuming ? options.resume : options.output;
  io::ScanTask task = resuming ? task_to_resume(options, folder / "scan.json") : task_of(options);
  const io::SceneFile file = io::read_scene(task.scene);
  const std::string content = content_of(task.scene, file);
  if (!options.mcap.empty() && !options.force && fs::exists(options.mcap))
    throw UsageError("--mcap: " + options.mcap + " exists already; " +
                     (resuming ? "name another file" : "--force overwrites it"));
  if (!options.mcap.empty()) io::AtomicFile(options.mcap);  // what cannot be written is told of before the scan
  if (resuming && content != task.content)
    throw FileError(task.scene + ": is not the scene with which the scan in " + folder.string() + " started");
  task.content = content;
  const study::TracedScene traced(file.scene, task.threads);
  check_scan(file.workcell, task.parameters);  // an impossible scan is rejected before anything is written
  std::unique_ptr<plan::Planner> planner = study_planner(task, file, traced);
  FolderLock lock;  // a list has its own
  if (!options.prepared) lock.take(folder.string());
  if (!resuming) {
    if (!options.prepared) {
      prepare_output(folder.string(), options.force);
      lock.take(folder.string());
    }
    io::write_scan_task(folder / "scan.json", task);
  } else if (options.mcap.empty() && is_finished(folder.string(), options)) {
    std::cerr << folder.string() << ": the scan is finished, there is nothing to do\n";
    return;
  } else {
    io::remove_leftovers(folder);
    io::remove_leftovers(folder / "views");
  }
  run_task(folder, task, file, traced, std::move(planner), options);
}

/// Scan every scene of the list.
int run_scans(const ScanOptions& options) {
  ListedCommand list{"scan", options.force, options.json, {options.parameter_file}, {}, {}, {}};
  if (!options.mcap.empty() && is_list(options.scenes, options.shard))
    throw UsageError("--mcap: is one file, so name one scene without --shard");
  list.run = [&](const std::string& input, const std::string& folder, Begin begin) {
    ScanOptions one = options;
    one.scene = input.empty() ? input : scene_file(input);
    one.output = folder;
    if (begin == Begin::resume && fs::exists(fs::path(folder) / "scan.json")) one.resume = folder;
    one.prepared = begin != Begin::as_asked;
    run_scan(one);
  };
  list.key = [&](const std::string& input) { return key_of(options, scene_file(input)); };
  list.is_complete = [&](const std::string& folder) { return is_finished(folder, options); };
  return run_inputs(options.scenes, options.shard, options.output, list);
}

}  // namespace

void add_scan(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("scan", "scan a scene with a simulated sensor and arm, and locate its fruit");
  auto options = std::make_shared<ScanOptions>();
  auto* scene = command->add_option("scene", options->scenes,
                                    "scene file (YAML), or a folder with scene.yaml; of several scenes, or a pattern, "
                                    "each gets its own folder in the output folder");
  auto* output = add_common_options(*command, *options);
  command
      ->add_option(
          "--planner", options->planner,
          "planner that chooses the views; greedy knows the truth, for comparison only (default: that of the preset)")
      ->check(one_of(planner_choices()));
  command->add_option("--noise", options->noise, std::string("noise model of the sensor: ") + study::kNoiseNames)
      ->capture_default_str();
  command->add_option("--light", options->light, "light on the plant, for the noise models l515, azure and d405")
      ->check(one_of({"shade", "sun"}));
  command->add_flag("--color", options->color, "simulate colors, so that each fruit gets a ripeness");
  command
      ->add_option("--detector", options->detector,
                   "simulate a detector and use its masks, which have errors; implies --color")
      ->check(one_of(std::vector<std::string>(study::kDetectorNames.begin(), study::kDetectorNames.end())));
  command->add_option("--max-views", options->max_views, "largest number of views (default: that of the preset)")
      ->check(CLI::Range(1, 10000));
  command->add_flag("--live", options->live,
                    "write report.html after every view; a browser that shows the page follows the scan");
  command->add_option("--mcap", options->mcap,
                      "also write the scan to this MCAP file, for Foxglove and ROS 2; for a single scene");
  add_shard_option(*command, options->shard);
  auto* resume =
      command->add_option("--resume", options->resume,
                          "continue the interrupted scan in this folder; name the scene only if its file was moved");
  for (const char* given : {"--output", "--preset", "--params", "--radius", "--seed", "--force", "--planner", "--noise",
                            "--light", "--max-views", "--shard", "--color", "--detector"})
    resume->excludes(given);  // a resumed scan keeps the values that it was started with
  command->footer(
      "Examples:\n"
      "  agrisee scan truss/scene.yaml -o result --noise l515 --seed 1\n"
      "  agrisee scan truss/scene.yaml -o paper --preset paper --noise gaussian:0.002 --max-views 20\n"
      "  agrisee scan cherries/scene.yaml -o result --radius 0.01,0.02\n"
      "  agrisee scan plant/scene.yaml -o result --noise l515 --detector typical\n"
      "  agrisee scan --resume result\n"
      "  agrisee scan 'season/*/scene.yaml' -o results --shard 2/8\n"
      "The output folder then holds cloud.ply, cloud_raw.ply, views.csv, fruits.json, fruits.csv, run.json, truss.png\n"
      "and report.html, and what --resume needs: scan.json and views/, with one file per view.");
  command->callback([options, scene, output, resume, &run] {
    if (resume->count() == 0)
      for (const CLI::Option* needed : {scene, output})
        if (needed->count() == 0) throw CLI::RequiredError(needed->get_name());
    if (resume->count() > 0 && options->scenes.size() > 1)
      throw CLI::ValidationError("--resume", "continues one scan, so at most one scene can be named");
    run = [options] { return run_scans(*options); };
  });
}

}  // namespace agrisee::cli
