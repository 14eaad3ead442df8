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

std::string how_to_read_it(const Data& data, bool per_truss) {
  std::string out = "## How to read it\n\n";
  out +=
      "- `8.3 (12.0)`: our value, and in parentheses the paper's for the truss with the same counts. Where the paper "
      "has no such truss, our value stands alone.\n";
  if (per_truss)
    out +=
        "- A row is the mean over the trials of a scene. `average` is the mean over the rows, `worst row` is the worst "
        "row of each column, and `worst scan` is the worst single trial. The paper's values in these three rows are "
        "those of the same scenes. Tables of figures that the paper does not report show all scenes together; the CSV "
        "files have every scan.\n";
  out +=
      "- `-`: there is no value. `7.0 [2/3]`: only 2 of 3 scans have a value, and this is their mean; then there is no "
      "worst value.\n";
  out += "- Seconds are computing time on the machine that ran it, without the simulated sensor.\n";
  out +=
      "- A group is a preset, a planner and a noise model; with `free flight` the camera flies to every view instead "
      "of being held by the arm. ";
  out += per_truss
             ? "The detailed tables show one group per preset. The other groups are in the summary and in the CSV "
               "files: "
             : "The CSV files have a row per scan: ";
  for (const char* name : {"scanning", "segmentation", "localization", "fruits", "curves", "scenes"})
    out +=
        (name == std::string("scanning") ? "[" : ", [") + std::string(name) + "](" + data.folder + "/" + name + ".csv)";
  return out + ".\n\n";
}

}  // namespace

std::string introduction(const Data& data, const ReportInfo& info) {
  std::string out = info.per_truss ? "# The paper's experiment, side by side\n\n" : "# Planners, side by side\n\n";
  out +=
      "A simulated depth sensor on a UR3 scans trusses of tomatoes, and the results of AgriSEE are compared with the "
      "true surfaces. Beside each value is the one that the paper reports in its three result tables (F. "
      "Cañadas-Aránega, R. Border, J. C. Moreno, J. L. Blanco-Claraco: *Active perception for robotic harvesting: 3D "
      "reconstruction and localisation of tomatoes hidden within clusters in a Mediterranean greenhouse*). The cluster "
      "models of the paper are not public; scenes with the same numbers of fruit and hidden fruit were generated from "
      "fixed seeds. A difference from the paper's value is therefore due to both the method and the scene. The `paper` "
      "and `default` presets scan the same scenes.\n\n";
  out +=
      "The command below writes this page from the records of the scans. All values but the paper's are measured.\n\n";
  return out + what_was_run(data, info) + how_to_read_it(data, info.per_truss);
}

}  // namespace agrisee::report
