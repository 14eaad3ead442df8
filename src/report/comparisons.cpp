// SPDX-License-Identifier: BSD-3-Clause
// The sections that compare groups: presets under noise, and planners.
#include <algorithm>

#include "report/errors.hpp"
#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {

using Cells = std::vector<std::string>;

std::string noise_section(const Data& data) {
  using namespace figure;
  std::string out = "## The paper's parameters under noise\n\n";
  const std::vector<std::string> presets = distinct(data, &Group::preset);
  if (std::find(presets.begin(), presets.end(), "paper") == presets.end())
    return out + "The records do not contain the `paper` preset.\n\n";
  out +=
      "Each preset with its own planner, under each noise model that it was run with. `none` is a perfect sensor. "
      "`gaussian:S` adds independent errors with a standard deviation of S metres along the ray; the paper states "
      "0.01. `l515` imitates a real L515 (docs/sensors.md). `rough` is harder: correlated errors, a bias per "
      "view, flying pixels and a wrong pose.\n\n";
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
      cells.push_back(fixed(times(1e3, repeatability(*group).mean), 2));
      cells.push_back(stop_reasons(*group));
      table.row(cells);
    }
  return out + table.markdown() + "\n";
}

namespace {

/// All groups, by what was scanned alone.
std::string scanned_table(const Data& data) {
  using namespace figure;
  Cells head{"preset / planner / noise", "scans", "views"};
  constexpr int kAfter[] = {3, 12, 20, 50};
  for (const int n : kAfter) head.push_back("after " + std::to_string(n) + " %");
  for (const Figure* f : {&scanned, &scanned_obs, &plan_ms}) head.emplace_back(f->title);
  head.emplace_back("stopped by");
  Table table(head);
  for (const Group& group : data.groups) {
    const auto both = [&](const Figure& f) { return pair(mean(group, f).value, worst_row(group, f), f.digits); };
    Cells cells{text(group.name()), std::to_string(group.scans()), both(views)};
    for (const int n : kAfter) cells.push_back(fixed(times(100.0, whole_after(group, n)), 1));
    for (const Figure* f : {&scanned, &scanned_obs, &plan_ms}) cells.push_back(both(*f));
    cells.push_back(stop_reasons(group));
    table.row(cells);
  }
  return "All groups, by the share of the fruit's surface that is within 5 mm of any merged point, whatever becomes of "
         "the points later: of the whole surface after 3, 12, 20 and 50 views (a scan that has ended keeps its last "
         "value) and at the end, and of the part that the arm can observe at the end.\n\n" +
         table.markdown() + "\n";
}

}  // namespace

std::string planner_section(const Data& data) {
  using namespace figure;
  const std::string noise = comparison_noise(data);
  const auto compared = [&](const Group& group) { return group.noise == noise && group.reach == "arm"; };
  const auto count = std::count_if(data.groups.begin(), data.groups.end(), compared);
  std::string out = "## Planners\n\n";
  out +=
      "The share of the observable surface that is within 5 mm of a point, after each view: the mean over the scenes "
      "under the noise model " +
      text(noise) + ". A scan that has ended keeps its last value. ";
  out += count > 1 ? "The table gives `average / worst row`. `views to 95 %` is the mean over the scans that reached "
                     "95 %; their number is in brackets if some did not.\n\n"
                   : "The records contain only one planner under this noise model, so there is no comparison.\n\n";
  if (std::any_of(data.groups.begin(), data.groups.end(), [](const Group& g) { return g.planner == "greedy"; }))
    out +=
        "`greedy` knows the true surfaces. After the frontal view it always takes the view that shows most of the "
        "surface not seen yet. No robot could use it; it is the limit for the other planners.\n\n";
  out += picture(data, "planners.svg", "Share of the observable surface that is scanned after each view, per planner");
  out += "The curves of all scans: [curves.csv](" + data.folder + "/curves.csv).\n\n";
  out += scanned_table(data);
  if (count < 2) return out;
  Table table({"preset / planner", "scans", "views", "views to 95 %", "scanned, observable %", "R_obj %", "path rad",
               "path / shortest", "stopped by"});
  for (const Group& group : data.groups) {
    if (!compared(group)) continue;
    const auto both = [&](const Figure& f) { return pair(mean(group, f).value, worst_row(group, f), f.digits); };
    table.row({text(group.preset + " / " + group.planner), std::to_string(group.scans()), both(views),
               shown(mean(group, views_95), 1), both(scanned_obs), both(object_recall), both(path), both(path_ratio),
               stop_reasons(group)});
  }
  return out + table.markdown() + "\n";
}

}  // namespace agrisee::report
