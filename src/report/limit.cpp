// SPDX-License-Identifier: BSD-3-Clause
// The section on what the arm can see of each scene.
#include <agrisee/study/paper_tables.hpp>

#include <algorithm>

#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {
namespace {

using Cells = std::vector<std::string>;

/// A row per scene: what can be seen of it, the views of the greedy planner, and those of the main groups.
std::string limit_table(const Data& data) {
  const std::vector<const Group*> main = main_groups(data);
  Cells head{"scene", "fruit / hidden", "observable %", "least fruit %", "hidden, from in front %",
             "90 %",  "95 %",           "98 %",         "99 %"};
  for (const Group* group : main) head.push_back("95 %: " + text(group->name()));
  Table table(head);
  for (const SceneRecord* scene : data.scenes) {
    Cells cells{text(scene->scene), std::to_string(scene->total) + " / " + std::to_string(scene->hidden),
                fixed(100.0 * scene->observable, 1), fixed(100.0 * scene->observable_least, 1),
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
  return table.markdown();
}

/// The smallest and largest share of the scenes, in percent.
std::string range(const Data& data, double SceneRecord::*share) {
  std::vector<double> values;
  for (const SceneRecord* scene : data.scenes) values.push_back(100.0 * scene->*share);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return fixed(*low, 1) + " to " + fixed(*high, 1) + " %";
}

}  // namespace

std::string limit_section(const Data& data) {
  std::string out = "## What is physically possible\n\n";
  if (data.scenes.empty()) return out + "The records do not say what can be seen of the scenes.\n\n";
  out +=
      "Computed with a dense set of sensor poses that the arm can reach, for incidence below 80 degrees: the share of "
      "the fruit's surface that can be seen, and of the fruit of which least can be seen; the largest share of a "
      "hidden "
      "fruit that is visible from straight in front; the views with which a greedy planner that knows the truth sees "
      "90, 95, 98 and 99 % of the observable surface (`-`: never); and the views to 95 % of the planners above.\n\n";
  out += "From this position of the arm " + range(data, &SceneRecord::observable) + " of a truss can be seen, and " +
         range(data, &SceneRecord::observable_least) +
         " of its least visible fruit: hidden fruit are hidden from the front, not from all sides.";
  std::size_t with_paper = 0, beyond = 0;
  for (const SceneRecord* scene : data.scenes)
    if (const auto* paper = study::paper_scanning(scene->total, scene->hidden)) {
      ++with_paper;
      beyond += paper->scanned > 100.0 * scene->observable;
    }
  if (with_paper > 0)
    out += " In " + std::to_string(beyond) + " of the " + std::to_string(with_paper) +
           " scenes with the counts of the paper, its scanned percentage is larger than the observable share here: its "
           "models and the position of its robot are different.";
  return out + "\n\n" + limit_table(data) + "\n";
}

}  // namespace agrisee::report
