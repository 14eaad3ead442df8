// SPDX-License-Identifier: BSD-3-Clause
// The head of the report: what was run, and how to read the tables.
#include <algorithm>
#include <set>
#include <tuple>

#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {
namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + text(name);
  return out;
}

std::string counted(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// The scenes of all groups, by number of fruit, number of hidden fruit, and name.
std::vector<std::string> scene_names(const Data& data) {
  std::set<std::tuple<int, int, std::string>> sorted;
  for (const Group& group : data.groups)
    for (const Row& row : group.rows) sorted.insert({row.total, row.hidden, row.scene});
  std::vector<std::string> names;
  for (const auto& [total, hidden, scene] : sorted) names.push_back(scene);
  return names;
}

/// The numbers of the trials of all groups.
std::vector<std::string> trials(const Data& data) {
  std::set<int> numbers;
  for (const Group& group : data.groups)
    for (const Row& row : group.rows)
      for (const CellRecord* cell : row.trials) numbers.insert(cell->cell.trial);
  std::vector<std::string> names;
  for (const int n : numbers) names.push_back(std::to_string(n));
  return names;
}

std::string what_was_run(const Data& data, const ReportInfo& info) {
  const std::vector<std::string> scenes = scene_names(data), runs = trials(data);
  std::size_t scans = 0;
  for (const Group& group : data.groups) scans += group.scans();
  std::string out = "## What was run\n\n";
  out += "AgriSEE " + text(info.version) + ", " + counted(scans, "scan", "scans") + ":\n\n";
  out += "- " + counted(scenes.size(), "scene", "scenes") + ": " + joined(scenes) + "\n";
  out += "- presets: " + joined(distinct(data, &Group::preset)) +
         "; planners: " + joined(distinct(data, &Group::planner)) +
         " (gain is the planner of the default preset, see that of the others)\n";
  out += "- noise models of the sensor: " + joined(noises(data)) + "\n";
  out += "- trials, each with its own seed: " + joined(runs) + "\n";
  if (scans != data.groups.size() * scenes.size() * runs.size())
    out += "\n**Not every group has all scenes and trials.** Averages are over those that it has.\n";
  out += "\nTo run it again:\n\n    ";
  for (const char c : info.command) out += c == '\n' ? std::string("\n    ") : std::string(1, c);
  return out + "\n\n";
}

/// Links to CSV files.
std::string links(const Data& data, const std::vector<const char*>& names) {
  std::string out;
  for (const char* name : names)
    out += (out.empty() ? "[" : ", [") + std::string(name) + "](" + data.folder + "/" + name + ".csv)";
  return out;
}

std::string how_to_read_it(const Data& data, bool per_truss) {
  const std::string group =
      "- A group is a preset, a planner and a noise model; with `free flight` the camera flies to every view instead "
      "of being held by the arm. ";
  const std::string seconds = "- Seconds are computing time, without the simulated sensor.\n";
  if (!per_truss)
    return "## How to read it\n\n" + group + "As a file, with a row per scan: " + links(data, {"scanning"}) +
           ".\n- Cells `average / worst`: the mean over the scenes, and the worst of them. In parentheses: the "
           "paper's.\n" +
           seconds + "\n";
  return "## How to read it\n\n"
         "- `8.3 (12.0)`: our value, and in parentheses the paper's for the truss with the same counts, if any.\n"
         "- A row is the mean over the trials of a scene, `average` the mean over the rows, `worst row` the worst row "
         "of each column, `worst scan` the worst single trial. Cells `average / worst` show the first two.\n"
         "- `-`: no value. `7.0 [2/3]`: the mean of the 2 of 3 scans that have one; then there is no worst value.\n" +
         seconds + group + "Tables 1 to 3 show one group per preset. As files, with all groups: " +
         links(data, {"scanning", "segmentation", "localization", "fruits", "curves", "scenes"}) + ".\n\n";
}

}  // namespace

std::string introduction(const Data& data, const ReportInfo& info) {
  const std::string what =
      info.per_truss
          ? "# The paper's experiment, side by side\n\n"
            "A simulated depth sensor on a UR3 scans trusses of tomatoes; what AgriSEE finds is compared with "
            "the true surfaces, and with the values that the paper reports (docs/paper.md). Its models are not "
            "public: these scenes have the same numbers of fruit and hidden fruit, so a difference is due to "
            "both the method and the scene. All presets scan the same scenes.\n\n"
          : "# Planners, side by side\n\n"
            "The scenes of the paper's experiment (docs/experiment.md), scanned with every planner.\n\n";
  return what + what_was_run(data, info) + how_to_read_it(data, info.per_truss);
}

}  // namespace agrisee::report
