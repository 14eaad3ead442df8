// SPDX-License-Identifier: BSD-3-Clause
// agrisee faults: scans whose sensor and arm go wrong.
#include <agrisee/io/fault_report.hpp>
#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/version.hpp>

#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <sstream>

#include "commands.hpp"
#include "simulate.hpp"
#include "trusses.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

struct FaultOptions {
  std::string report, noise = "l515", preset = "default";
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

std::optional<study::Fault> kind_of(const std::string& name) {
  for (std::size_t k = 0; k < study::kFaults; ++k)
    if (name == to_string(static_cast<study::Fault>(k))) return static_cast<study::Fault>(k);
  return std::nullopt;
}

struct Subject {
  std::string name;
  Workcell workcell;
  std::shared_ptr<const study::Truth> truth;
};

Subject subject_of(const std::string& text) {
  const auto truss = truss_by_name(text);
  const io::SceneFile file = truss ? io::SceneFile{truss->workcell, truss->scene} : io::read_scene(text);
  const auto known =
      truss ? std::optional(truss->truth) : io::read_ground_truth(fs::path(text).parent_path() / "ground_truth.json");
  return {file.workcell.name, file.workcell, cli::make_truth(file.scene, known, file.workcell.sensor)};
}

template <typename T>
std::string joined(const std::vector<T>& values) {
  std::ostringstream out;
  for (std::size_t i = 0; i < values.size(); ++i) out << (i ? "," : "") << values[i];
  return out.str();
}

std::string command_of(const FaultOptions& options) {
  std::ostringstream text;
  text << "agrisee faults --report FILE --kinds " << joined(options.kinds) << " --rates " << joined(options.rates)
       << " --noise " << options.noise << " --preset " << options.preset << " --trials " << options.trials;
  if (!options.scenes.empty()) text << " --scenes " << joined(options.scenes);
  return text.str();
}

int run_faults(const FaultOptions& options) {
  const fs::path report = options.report;
  if (!report.has_extension()) throw UsageError(options.report + ": needs an extension such as .md");
  for (const fs::path& path : {report, report.parent_path() / report.stem()})
    if (!options.force && fs::exists(path)) throw UsageError(path.string() + ": exists; use --force to overwrite it");
  sensor::NoiseModel noise;
  try {
    noise = sensor::parse_noise(options.noise);
  } catch (const ParameterError& e) {
    throw UsageError(e.what());
  }
  const Parameters parameters = Parameters::named(options.preset);
  std::vector<Subject> subjects;
  for (const std::string& text : options.scenes.empty() ? paper_truss_names() : options.scenes)
    subjects.push_back(subject_of(text));
  struct Job {
    std::size_t subject;
    study::FaultParameters faults;
    int trial;
  };
  std::vector<Job> jobs;
  for (const std::string& kind : options.kinds)
    for (const double rate : options.rates)
      for (std::size_t s = 0; s < subjects.size(); ++s)
        for (int trial = 1; trial <= options.trials; ++trial) {
          study::FaultParameters faults;
          faults.rate = rate;
          faults.kind = kind_of(kind);
          jobs.push_back({s, faults, trial});
        }
  std::vector<study::FaultRecord> records(jobs.size());
  std::mutex mutex;
  std::size_t done = 0;
  parallel_for(
      jobs.size(), threads_of(options.threads),
      [&](std::size_t i) {
        const Job& job = jobs[i];
        const Subject& subject = subjects[job.subject];
        study::FaultRecord r = cli::scan_with_faults(subject.name, subject.workcell, *subject.truth, parameters, noise,
                                                     job.faults, job.trial);
        const std::lock_guard<std::mutex> lock(mutex);
        std::cerr << "[" << ++done << "/" << jobs.size() << "] " << r.scene << ", " << r.kind << " at "
                  << 100.0 * r.rate << " %: " << r.found << "/" << r.fruit << " fruit, " << r.invented << " invented, "
                  << r.discarded << " of " << r.views << " views discarded\n";
        records[i] = std::move(r);
      },
      1);
  io::write_fault_report(report, records, {AGRISEE_VERSION, command_of(options)});
  std::cout << "Report: " << report.string() << "\n";
  return kSuccess;
}

}  // namespace

void add_faults(CLI::App& app, Run& run) {
  auto* command =
      app.add_subcommand("faults", "scan while sensor and arm go wrong, and tell what is found all the same");
  auto options = std::make_shared<FaultOptions>();
  command
      ->add_option("--report", options->report, "Markdown file to write; its tables and plot go in a folder beside it")
      ->required();
  command->add_option("--kinds", options->kinds, "faults: any, or one kind alone")
      ->delimiter(',')
      ->check(CLI::IsMember(kind_names()))
      ->capture_default_str();
  command->add_option("--rates", options->rates, "shares of the views that go wrong")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--noise", options->noise, "noise of the sensor: none, gaussian:SIGMA, l515 or rough")
      ->capture_default_str();
  command->add_option("--preset", options->preset, "parameters: default, or paper")
      ->check(CLI::IsMember({"default", "paper"}))
      ->capture_default_str();
  command->add_option("--scenes", options->scenes, "scene files or trusses by name (7_1); default: the paper's eleven")
      ->delimiter(',');
  command->add_option("--trials", options->trials, "trials; their numbers are the seeds")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "scans at a time (0: as many as cores)")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--force", options->force, "overwrite an existing report");
  command->footer("Example:\n  agrisee faults --report faults.md --kinds any,wrong_pose --rates 0,0.1,0.3");
  command->callback([options, &run] { run = [options] { return run_faults(*options); }; });
}

}  // namespace agrisee::cli
