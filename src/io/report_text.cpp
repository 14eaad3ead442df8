// SPDX-License-Identifier: BSD-3-Clause
// What a report says around its tables: what was run, noise, planners, what can be seen at all.
#include <agrisee/study/paper_tables.hpp>

#include <algorithm>
#include <set>
#include <tuple>

#include "report_data.hpp"

namespace agrisee::io::report {
namespace {

using Cells = std::vector<std::string>;

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + text(name);
  return out;
}

std::string counted(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

std::vector<std::string> scene_names(const Data& data) {
  std::set<std::tuple<int, int, std::string>> sorted;
  for (const Group& group : data.groups)
    for (const Row& row : group.rows) sorted.insert({row.total, row.hidden, row.scene});
  std::vector<std::string> names;
  for (const auto& [total, hidden, scene] : sorted) names.push_back(scene);
  return names;
}

std::vector<std::string> trials(const Data& data) {
  std::set<int> numbers;
  for (const Group& group : data.groups)
    for (const Row& row : group.rows)
      for (const CellRecord* cell : row.trials) numbers.insert(cell->cell.trial);
  std::vector<std::string> names;
  for (const int n : numbers) names.push_back(std::to_string(n));
  return names;
}

}  // namespace

std::string picture(const Data& data, const std::string& file, const std::string& says) {
  return "![" + text(says) + "](" + data.folder + "/" + file + ")\n\n";
}

std::string introduction(const Data& data, const ReportInfo& info) {
  const std::vector<std::string> scenes = scene_names(data), runs = trials(data);
  std::size_t scans = 0;
  for (const Group& group : data.groups) scans += group.scans();
  std::string out = "# The paper's experiment, side by side\n\n";
  out +=
      "Trusses of tomatoes are scanned by a simulated depth sensor on a UR3, and what AgriSEE makes of the scans is "
      "judged "
      "by the true surfaces. Beside each figure stands what the paper reports in its three result tables (F. "
      "Cañadas-Aránega, R. Border, J. C. Moreno, J. L. Blanco-Claraco: *Active perception for robotic harvesting: 3D "
      "reconstruction and localisation of tomatoes hidden within clusters in a Mediterranean greenhouse*). The paper's "
      "own "
      "cluster models are not public; scenes with its counts of total and hidden fruit were made anew from fixed "
      "seeds. "
      "So a difference from the paper's figure is one of method and scene together, while the `paper` and `default` "
      "presets see the same scenes.\n\n";
  out +=
      "This page is written by the command below from the records of the scans; only the paper's figures are not "
      "measured.\n\n";
  out += "## What was run\n\n";
  out += "AgriSEE " + text(info.version) + ", " + counted(scans, "scan", "scans") + ":\n\n";
  out += "- " + counted(scenes.size(), "scene", "scenes") + ": " + joined(scenes) + "\n";
  out += "- presets: " + joined(distinct(data, &Group::preset)) +
         "; planners: " + joined(distinct(data, &Group::planner)) +
         " (gain is the default preset's own, see the paper's)\n";
  out += "- noise models of the sensor: " + joined(noises(data)) + "\n";
  out += "- trials, each with its own seed: " + joined(runs) + "\n";
  if (scans != data.groups.size() * scenes.size() * runs.size())
    out += "\n**Not every group has every scene and trial;** averages are over what there is.\n";
  out += "\nTo run it again:\n\n    ";
  for (const char c : info.command) out += c == '\n' ? std::string("\n    ") : std::string(1, c);
  out += "\n\n## How to read it\n\n";
  out +=
      "- `8.3 (12.0)`: ours, and in parentheses the paper's figure of the truss with the same counts. Scenes that the "
      "paper does not have show ours alone.\n"
      "- A row is the mean over its trials. `average` is the mean over the rows; `worst row` the worst of them, column "
      "by "
      "column; `worst scan` the worst single trial. The paper's figures in these rows are those of the same scenes.\n"
      "- `-`: there is no value. `7.0 [2/3]`: the mean of the 2 of 3 scans that have one; where only some have, there "
      "is no "
      "worst.\n"
      "- Seconds are computing alone, without the simulated sensor, on whatever machine ran it.\n"
      "- A group is a preset, a planner and a noise model. The detailed tables show one group a preset, the others are "
      "in "
      "the summary and in the CSV files: [scanning](" +
      data.folder + "/scanning.csv), [segmentation](" + data.folder + "/segmentation.csv), [localization](" +
      data.folder + "/localization.csv), [fruits](" + data.folder + "/fruits.csv), [curves](" + data.folder +
      "/curves.csv), [scenes](" + data.folder + "/scenes.csv).\n\n";
  return out;
}

std::string noise_section(const Data& data) {
  using namespace figure;
  std::string out = "## The paper's parameters under noise\n\n";
  const std::vector<std::string> presets = distinct(data, &Group::preset);
  if (std::find(presets.begin(), presets.end(), "paper") == presets.end())
    return out + "The `paper` preset is not among the records.\n\n";
  out +=
      "Each preset with its own planner, under each noise model that it was run with. `none` is a perfect sensor; "
      "`gaussian:S` adds independent errors of S metres along the ray (the paper names 0.01); `l515` follows the "
      "sensor's "
      "published figures; `rough` is harder: correlated errors, a bias per view, flying pixels and a wrong pose.\n\n";
  out += picture(data, "noise.svg", "Object recall by noise model, per preset");
  const std::vector<const Figure*> columns{&views,         &seconds,     &precision, &recall_obs, &object_precision,
                                           &object_recall, &miou_surface};
  Cells head{"noise", "preset"};
  for (const Figure* f : columns) head.emplace_back(f->title);
  head.emplace_back("RMSE mm");
  head.emplace_back("stopped by");
  Table table(head);
  const std::vector<const Group*> groups = own_planner_groups(data);
  for (const std::string& noise : noises(data))
    for (const Group* group : groups) {
      if (group->noise != noise) continue;
      Cells cells{text(noise), text(group->preset)};
      for (const Figure* f : columns) cells.push_back(fixed(mean(*group, *f).value, f->digits));
      const Errors rmse = repeatability(*group);
      cells.push_back(fixed(rmse.mean ? std::optional(1e3 * *rmse.mean) : std::nullopt, 2));
      cells.push_back(stop_reasons(*group));
      table.row(cells);
    }
  return out + table.markdown() + "\n";
}

std::string planner_section(const Data& data) {
  using namespace figure;
  const std::string noise = comparison_noise(data);
  std::string out = "## Planners\n\n";
  std::size_t count = 0;
  for (const Group& group : data.groups) count += group.noise == noise;
  out +=
      "Share of the observable surface within 5 mm of a point, after each view: the mean over the scenes, under the "
      "noise "
      "model " +
      text(noise) + ". A scan that has ended keeps what it had. ";
  out += count > 1 ? "The table gives `average / worst row`; `views to 95 %` is the mean of the scans that got there, "
                     "whose number "
                     "is in brackets when not all did.\n\n"
                   : "Only one planner is among the records, so there is nothing to compare it with.\n\n";
  if (std::any_of(data.groups.begin(), data.groups.end(), [](const Group& g) { return g.planner == "greedy"; }))
    out +=
        "`greedy` knows the true surfaces and takes, after the frontal view, always the one that shows most of what is "
        "left: the limit that the others are measured by, not a planner that a robot could use.\n\n";
  out += picture(data, "planners.svg", "Recall of the observable surface after each view, per planner");
  out += "Every scan's curve: [curves.csv](" + data.folder + "/curves.csv).\n\n";
  if (count < 2) return out;
  Table table({"preset / planner", "scans", "views", "views to 95 %", "recall, observable %", "R_obj %", "path rad",
               "path / shortest", "stopped by"});
  for (const Group& group : data.groups) {
    if (group.noise != noise) continue;
    const auto both = [&](const Figure& f) { return pair(mean(group, f).value, worst_row(group, f), f.digits); };
    table.row({text(group.preset + " / " + group.planner), std::to_string(group.scans()), both(views),
               shown(mean(group, views_95), 1), both(recall_obs), both(object_recall), both(path), both(path_ratio),
               stop_reasons(group)});
  }
  return out + table.markdown() + "\n";
}

std::string limit_section(const Data& data) {
  std::string out = "## What is physically possible\n\n";
  if (data.scenes.empty()) return out + "The records do not say what can be seen of the scenes at all.\n\n";
  out +=
      "From a dense set of sensor poses that the arm can reach outside its keep-out volumes, with incidence below 80 "
      "degrees: the share of the fruit's surface that can be seen at all, the same of the fruit of which least can be "
      "seen, "
      "and the largest share of a hidden fruit that shows from straight in front. Then the views that a greedy planner "
      "needs "
      "which knows the truth, for 90, 95, 98 and 99 % of the observable surface (`-`: never), and for comparison the "
      "views "
      "to 95 % of the planners above. ";
  const std::vector<const Group*> main = main_groups(data);
  Cells head{"scene", "fruit / hidden", "observable %", "least fruit %", "hidden, from in front %",
             "90 %",  "95 %",           "98 %",         "99 %"};
  for (const Group* group : main) head.push_back("95 %: " + text(group->name()));
  Table table(head);
  std::size_t with_paper = 0, beyond = 0;
  std::vector<double> shares, least;
  for (const SceneRecord* scene : data.scenes) {
    shares.push_back(100.0 * scene->observable);
    least.push_back(100.0 * scene->observable_least);
    if (const auto* paper = study::paper_scanning(scene->total, scene->hidden)) {
      ++with_paper;
      beyond += paper->scanned > 100.0 * scene->observable;
    }
    Cells cells{text(scene->scene), std::to_string(scene->total) + " / " + std::to_string(scene->hidden),
                fixed(shares.back(), 1), fixed(least.back(), 1),
                scene->hidden > 0 ? fixed(100.0 * scene->hidden_share_most, 1) : "-"};
    for (const int n : {scene->views_90, scene->views_95, scene->views_98, scene->views_99})
      cells.push_back(n > 0 ? std::to_string(n) : "-");
    for (const Group* group : main) {
      const auto row =
          std::find_if(group->rows.begin(), group->rows.end(), [&](const Row& r) { return r.scene == scene->scene; });
      cells.push_back(row == group->rows.end() ? "-" : shown(mean(*row, figure::views_95), 1));
    }
    table.row(cells);
  }
  const auto range = [](const std::vector<double>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return fixed(*low, 1) + " to " + fixed(*high, 1) + " %";
  };
  out += range(shares) + " of a truss can be seen from this place of the arm, and " + range(least) +
         " of its least visible fruit: hidden fruit are hidden from the front, not from everywhere.";
  if (with_paper > 0)
    out += " In " + std::to_string(beyond) + " of the " + std::to_string(with_paper) +
           " scenes with the paper's counts the paper's scanned percentage is larger than the observable share here; "
           "its models "
           "and its place of the robot are others, and a point within 5 mm of an edge covers some surface beyond it.";
  return out + "\n\n" + table.markdown() + "\nAlso as [scenes.csv](" + data.folder + "/scenes.csv).\n\n";
}

}  // namespace agrisee::io::report
