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
  return out +
         "Each preset with its own planner; the values are in the tables above. `none` is a perfect sensor, `l515` "
         "imitates a real L515 (docs/sensors.md). `rough` is harder: correlated errors, a bias per view, flying pixels "
         "and a wrong pose. `gaussian:S` adds independent errors of S metres along the ray; the paper states "
         "0.01.\n\n" +
         picture(data, "noise.svg", "Object recall by noise model, per preset");
}

namespace {

/// All groups, by what was scanned alone.
std::string scanned_table(const Data& data) {
  using namespace figure;
  Cells head{"preset / planner / noise"};
  constexpr int kAfter[] = {3, 12, 20, 50};
  for (const int n : kAfter) head.push_back("after " + std::to_string(n) + " %");
  head.emplace_back(views_95.title);
  for (const Figure* f : {&scanned_obs, &path_ratio, &plan_ms}) head.emplace_back(f->title);
  head.emplace_back("stopped by");
  Table table(head);
  for (const Group& group : data.groups) {
    Cells cells{text(group.name())};
    for (const int n : kAfter) cells.push_back(fixed(times(100.0, whole_after(group, n)), 1));
    cells.push_back(shown(mean(group, views_95), 1));
    for (const Figure* f : {&scanned_obs, &path_ratio, &plan_ms}) cells.push_back(mean_and_worst(group, *f));
    cells.push_back(stop_reasons(group));
    table.row(cells);
  }
  return table.markdown();
}

}  // namespace

std::string planner_section(const Data& data) {
  std::string out = "## Planners\n\n";
  if (std::any_of(data.groups.begin(), data.groups.end(), [](const Group& g) { return g.planner == "greedy"; }))
    out +=
        "`greedy` knows the true surfaces and takes the view that shows most of the surface not seen yet. No robot "
        "could use it; it is the limit for the others.\n\n";
  out += picture(data, "planners.svg", "Share of the observable surface that is scanned after each view, per planner");
  out +=
      "The plot shows the scans under " + text(comparison_noise(data)) + " ([all curves](" + data.folder +
      "/curves.csv)). The columns: the share of the whole surface within 5 mm of a merged point after 3, 12, 20 and 50 "
      "views (a scan that has ended keeps its last value); the views to 95 % of the surface that the arm can observe, "
      "with the number of scans that got there if some did not; the share of that surface at the end; the length of "
      "the path over that of the shortest path through the same poses.\n\n";
  return out + scanned_table(data) + "\n";
}

}  // namespace agrisee::report
