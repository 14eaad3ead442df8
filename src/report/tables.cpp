// SPDX-License-Identifier: BSD-3-Clause
// Tables 1 and 2: scanning and segmentation.
#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {
namespace {

using Figures = std::vector<const Figure*>;
using Cells = std::vector<std::string>;

/// Adds the rows of the average, the worst scene and the worst scan.
void add_averages(Table& table, const Group& group, const Figures& figures) {
  Cells average{"**average**", ""}, worst{"**worst row**", ""}, scan{"**worst scan**", ""};
  for (const Figure* f : figures) {
    const auto paper = paper_mean(group, *f);
    average.push_back(shown(mean(group, *f), f == &figure::n_real ? 1 : f->digits, paper));
    worst.push_back(shown({worst_row(group, *f), 0, 0}, f->digits, paper_worst(group, *f)));
    scan.push_back(fixed(worst_scan(group, *f), f->digits));
  }
  for (const Cells& cells : {average, worst, scan}) table.row(cells);
}

/// A table with a row per scene, then the average, the worst row and the worst scan.
std::string scene_table(const Group& group, const Figures& figures) {
  Cells head{"scene", "fruit / hidden"};
  for (const Figure* f : figures) head.emplace_back(f->title);
  Table table(head);
  for (const Row& row : group.rows) {
    Cells cells{text(row.scene), std::to_string(row.total) + " / " + std::to_string(row.hidden)};
    for (const Figure* f : figures) {
      const auto paper = f->paper ? f->paper(row.total, row.hidden) : std::nullopt;
      cells.push_back(shown(mean(row, *f), f->digits, paper));
    }
    table.row(cells);
  }
  add_averages(table, group, figures);
  return table.markdown();
}

/// A table with a row per group: `average / worst row`, in parentheses the paper's average.
std::string group_table(const Data& data, const Figures& figures) {
  Cells head{"preset / planner / noise"};
  for (const Figure* f : figures) head.emplace_back(f->title);
  Table table(head);
  for (const Group* group : main_groups(data)) {
    Cells cells{text(group->name())};
    for (const Figure* f : figures) {
      const auto paper = paper_mean(*group, *f);
      cells.push_back(mean_and_worst(*group, *f) + (paper ? " (" + fixed(paper, f->digits) + ")" : ""));
    }
    table.row(cells);
  }
  return table.markdown();
}

}  // namespace

std::string scanning_section(const Data& data) {
  using namespace figure;
  std::string out = "## Table 1: scanning\n\n";
  out +=
      "As the paper's table of scanning and SOR. `scanned` is the share of the fruit's surface within 5 mm of any "
      "point of the cloud, `recall` that within 5 mm of a point of an instance, and `precision` the share of the "
      "points of instances within 5 mm of a fruit.\n\n";
  out += picture(data, "scanning.svg", "Scanned percentage and recall per scene, ours and the paper's");
  for (const Group* group : main_groups(data))
    out += "### " + text(group->name()) + "\n\n" +
           scene_table(*group, {&views, &merged, &filtered, &seconds, &scanned, &precision, &recall, &f1}) + "\n";
  out +=
      "What the paper leaves out: the share of the surface that the arm can observe; the precision over all points of "
      "the cloud, with stems and leaves, and at 2 mm; the share of the points that region growing leaves to DBSCAN; by "
      "how many percentage points the planner's estimates of the scanned and of the observable share are off.\n\n";
  return out +
         group_table(data,
                     {&observable, &precision_all, &precision_strict, &residual, &belief_seen, &belief_observable}) +
         "\n";
}

std::string segmentation_section(const Data& data) {
  using namespace figure;
  std::string out = "## Table 2: segmentation\n\n";
  out +=
      "A detection is true if its surface IoU with a fruit is at least 0.5. The mIoU is given over the observable "
      "surface (in parentheses the paper's, which does not say how it was computed) and over the points of the cloud. "
      "N_real is the number of fruit of our scene; for one truss the paper states another number.\n\n";
  out += picture(data, "segmentation.svg", "Object recall and mIoU per scene, ours and the paper's");
  for (const Group* group : main_groups(data))
    out += "### " + text(group->name()) + "\n\n" +
           scene_table(*group, {&n_real, &n_det, &counting_error, &object_precision, &object_recall, &miou_surface,
                                &miou_point, &views_all}) +
           "\n";
  out += "What each of the paper's two stages finds alone on the same clean cloud:\n\n";
  return out +
         group_table(
             data, {&growing_n, &growing_recall, &growing_miou, &clustering_n, &clustering_recall, &clustering_miou}) +
         "\n";
}

}  // namespace agrisee::report
