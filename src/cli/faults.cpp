// SPDX-License-Identifier: BSD-3-Clause
// agrisee faults: scans with faults of sensor and arm, and what they still find.
#include <agrisee/core/parallel.hpp>
#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/evaluate.hpp>
#include <agrisee/study/faults.hpp>
#include <agrisee/version.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>

#include "commands.hpp"
#include "report/fault_report.hpp"
#include "trusses.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

struct FaultOptions {
  std::string report, noise = "l515", preset = kPresetNames[0];
  std::vector<std::string> scenes, kinds{"any"};
  std::vector<double> rates{0.0, 0.01, 0.03, 0.1, 0.2, 0.3};
  int trials = 1, threads = 0;
  bool force = false;
};

std::vector<std::string> kind_names() {
  std::vector<std::string> names{"any"};
  for (std::size_t k = 0; k < study::kFaults; ++k) names.emplace_back(to_string(static_cast<study::Fault>(k)));
  return names;
}

/// The fault of a name; none for `any`.
std::optional<study::Fault> kind_of(const std::string& name) {
  for (std::size_t k = 0; k < study::kFaults; ++k)
    if (name == to_string(static_cast<study::Fault>(k))) return static_cast<study::Fault>(k);
  return std::nullopt;
}

/// A scene, with what its scans are judged by.
struct JudgedScene {
  std::string name;
  Workcell workcell;
  study::Truth truth;
};

/// Open a scene file, or generate a truss by name.
JudgedScene open_scene(const std::string& text) {
  const auto truss = truss_by_name(text);
  const io::SceneFile file = truss ? io::SceneFile{truss->workcell, truss->scene, {}} : io::read_scene(text);
  const auto known =
      truss ? std::optional(truss->truth) : io::read_ground_truth(fs::path(text).parent_path() / "ground_truth.json");
  return {file.workcell.name, file.workcell, study::make_truth(file.scene, known, file.workcell.sensor)};
}

/// One scan.
struct FaultScan {
  std::size_t scene;
  study::FaultParameters faults;
  int trial;
};

/// All scans, for this number of scenes.
std::vector<FaultScan> list_scans(const FaultOptions& options, std::size_t scene_count) {
  std::vector<FaultScan> scans;
  for (const std::string& kind : options.kinds)
    for (const double rate : options.rates)
      for (std::size_t s = 0; s < scene_count; ++s)
        for (int trial = 1; trial <= options.trials; ++trial) {
          study::FaultParameters faults;
          faults.rate = rate;
          faults.kind = kind_of(kind);
          scans.push_back({s, faults, trial});
        }
  return scans;
}

/// Run all scans; the records are in the order of `scans`.
std::vector<study::FaultRecord> run_scans(const std::vector<FaultScan>& scans, const std::vector<JudgedScene>& scenes,
                                          const Parameters& parameters, const study::NoiseModel& noise, int threads) {
  std::vector<study::FaultRecord> records(scans.size());
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(
      scans.size(), threads,
      [&](std::size_t i) {
        const FaultScan& one = scans[i];
        const JudgedScene& scene = scenes[one.scene];
        study::FaultRecord r =
            study::scan_with_faults(scene.name, scene.workcell, scene.truth, parameters, noise, one.faults, one.trial);
        const std::lock_guard<std::mutex> lock(mutex);
        std::cerr << "[" << ++done << "/" << scans.size() << "] " << r.scene << ", " << r.kind << " at "
                  << 100.0 * r.rate << " %: " << r.found << "/" << r.fruit << " fruit, " << r.invented << " invented, "
                  << r.discarded << " of " << r.views << " views discarded\n";
        records[i] = std::move(r);
      },
      1);
  return records;
}

template <typename T>
std::string joined(const std::vector<T>& values) {
  std::ostringstream out;
  for (std::size_t i = 0; i < values.size(); ++i) out << (i ? "," : "") << values[i];
  return out.str();
}

/// The command that repeats the scans.
std::string command_of(const FaultOptions& options) {
  std::ostringstream text;
  text << "agrisee faults --report FILE --kinds " << joined(options.kinds) << " --rates " << joined(options.rates)
       << " --noise " << options.noise << " --preset " << options.preset << " --trials " << options.trials;
  if (!options.scenes.empty()) text << " --scenes " << joined(options.scenes);
  return text.str();
}

/// @throws UsageError if a value is there twice: each scan would count twice
template <typename T>
void check_distinct(const char* option, std::vector<T> values) {
  std::sort(values.begin(), values.end());
  const auto twice = std::adjacent_find(values.begin(), values.end());
  if (twice != values.end()) throw UsageError(std::string(option) + ": " + joined<T>({*twice}) + " is there twice");
}

int run_faults(const FaultOptions& options) {
  check_distinct("--kinds", options.kinds);
  check_distinct("--rates", options.rates);
  const fs::path path = options.report;
  if (!path.has_extension()) throw UsageError(options.report + ": needs an extension such as .md");
  for (const fs::path& written : {path, path.parent_path() / path.stem()})
    if (!options.force && fs::exists(written))
      throw UsageError(written.string() + ": exists; use --force to overwrite it");
  const study::NoiseModel noise = noise_of(options.noise);
  const Parameters parameters = Parameters::named(options.preset);
  std::vector<JudgedScene> scenes;
  std::set<std::string> names;
  for (const std::string& text : options.scenes.empty() ? paper_truss_names() : options.scenes) {
    scenes.push_back(open_scene(text));
    take_scene_name(names, scenes.back().name, text);
  }
  const std::vector<FaultScan> scans = list_scans(options, scenes.size());
  const std::vector<study::FaultRecord> records =
      run_scans(scans, scenes, parameters, noise, threads_of(options.threads));
  report::write_fault_report(path, records, {AGRISEE_VERSION, command_of(options)});
  std::cout << "Report: " << path.string() << "\n";
  return kSuccess;
}

}  // namespace

void add_faults(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand("faults", "simulate faults of sensor and arm, and report what is still found");
  auto options = std::make_shared<FaultOptions>();
  command
      ->add_option("--report", options->report, "Markdown file to write; its table and plot go into a folder beside it")
      ->required();
  command->add_option("--kinds", options->kinds, "kinds of fault: any (all of them mixed), or single kinds")
      ->delimiter(',')
      ->check(one_of(kind_names()))
      ->capture_default_str();
  command->add_option("--rates", options->rates, "shares of the views that go wrong")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--noise", options->noise, std::string("noise model of the sensor: ") + study::kNoiseNames)
      ->capture_default_str();
  command->add_option("--preset", options->preset, "parameter values")
      ->check(one_of(preset_choices()))
      ->capture_default_str();
  command
      ->add_option("--scenes", options->scenes,
                   "scene files, or trusses by name (7_1); default: the eleven of paper-scenes")
      ->delimiter(',');
  command->add_option("--trials", options->trials, "number of trials per scene; the seeds are 1, 2, ...")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "number of scans at a time (0: one per core)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--force", options->force, "overwrite an existing report");
  command->footer("Example:\n  agrisee faults --report faults.md --kinds any,wrong_pose --rates 0,0.1,0.3");
  command->callback([options, &run] { run = [options] { return run_faults(*options); }; });
}

}  // namespace agrisee::cli
