// SPDX-License-Identifier: BSD-3-Clause
#include "experiment_cells.hpp"

#include <agrisee/io/files.hpp>
#include <agrisee/io/fingerprint.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/version.hpp>

#include <algorithm>
#include <set>
#include <sstream>

#include "commands.hpp"
#include "trusses.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

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

/// Scans that have all but scene and trial in common.
struct GroupOfCells {
  std::string preset, planner, noise, reach = "arm";
};

/// PRESET/PLANNER/NOISE or PRESET/PLANNER/NOISE/free.
GroupOfCells parse_group(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
  const auto known = [&](std::size_t i, const std::vector<std::string>& choices) {
    return std::find(choices.begin(), choices.end(), parts[i]) != choices.end();
  };
  if (parts.size() < 3 || parts.size() > 4 || !known(0, preset_choices()) || !known(1, planner_choices()) ||
      (parts.size() == 4 && parts[3] != "free"))
    throw UsageError("--groups: expected PRESET/PLANNER/NOISE or PRESET/PLANNER/NOISE/free, got " + text);
  noise_of(parts[2]);
  return {parts[0], parts[1], parts[2], parts.size() == 4 ? "free" : "arm"};
}

/// The groups of --groups or, without that, all combinations of presets, planners and noise models.
std::vector<GroupOfCells> groups_of(const ExperimentOptions& options) {
  std::vector<GroupOfCells> groups;
  for (const std::string& text : options.groups) groups.push_back(parse_group(text));
  if (!groups.empty()) return groups;
  for (const std::string& preset : options.presets) {
    const std::vector<std::string> own{Parameters::named(preset).planner};
    for (const std::string& planner : options.planners.empty() ? own : options.planners)
      for (const std::string& noise : options.noises) groups.push_back({preset, planner, noise});
  }
  return groups;
}

Parameters parameters_of(const ExperimentOptions& options, const std::string& preset) {
  Parameters parameters = Parameters::named(preset);
  if (!options.parameter_file.empty()) parameters = changed_by(options.parameter_file, parameters, "--presets");
  if (options.max_views > 0) parameters.max_views = options.max_views;
  return parameters;
}

}  // namespace

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
    take_scene_name(names, jobs.back().name, text);
  }
  return jobs;
}

std::vector<CellJob> list_cells(const ExperimentOptions& options, const std::vector<SceneJob>& scenes) {
  std::vector<CellJob> jobs;
  std::set<std::string> names;
  for (std::size_t s = 0; s < scenes.size(); ++s)
    for (const GroupOfCells& group : groups_of(options))
      for (int trial = 1; trial <= options.trials_of(group.preset); ++trial) {
        CellJob job;
        job.cell = {scenes[s].name, group.preset, group.planner, to_string(study::parse_noise(group.noise)), trial};
        job.cell.reach = group.reach;
        if (!names.insert(job.cell.name()).second) continue;
        job.scene = s;
        job.parameters = parameters_of(options, group.preset);
        io::Fingerprint print;
        print.add(scenes[s].fingerprint);
        print.add(io::parameters_to_json(job.parameters));
        if (options.scanned_only) print.add("scanned only");
        job.fingerprint = print.text();
        job.path = fs::path(options.output) / "cells" / (job.cell.name() + ".json");
        jobs.push_back(std::move(job));
      }
  return jobs;
}

}  // namespace agrisee::cli
