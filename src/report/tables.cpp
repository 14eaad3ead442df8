// SPDX-License-Identifier: BSD-3-Clause
// Tables 1 and 2: scanning and segmentation.
#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {
namespace {

using Figures = std::vector<const Figure*>;
using Cells = std::vector<std::string>;

/// Adds the rows of the average, the worst scene and the worst scan. `before` are the cells between the name of the row
/// and the figures; with `stopped`, a last cell says why the scans stopped.
void add_averages(Table& table, const Group& group, const Figures& figures, const Cells& before, const char* stopped) {
  Cells average{"**average**"}, worst{"**worst row**"}, scan{"**worst scan**"};
  for (Cells* cells : {&average, &worst, &scan}) cells->insert(cells->end(), before.begin(), before.end());
  for (const Figure* f : figures) {
    const auto paper = paper_mean(group, *f);
    average.push_back(shown(mean(group, *f), f == &figure::n_real ? 1 : f->digits, paper));
    worst.push_back(shown({worst_row(group, *f), 0, 0}, f->digits, paper_worst(group, *f)));
    scan.push_back(fixed(worst_scan(group, *f), f->digits));
  }
  if (stopped) {
    average.push_back(stop_reasons(group));
    worst.emplace_back("");
    scan.emplace_back("");
  }
  table.row(average);
  table.row(worst);
  table.row(scan);
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
  add_averages(table, group, figures, {""}, nullptr);
  return table.markdown();
}

/// A table of the average, the worst row and the worst scan alone. `stopped` is the title of a last column with the
/// reasons why the scans stopped; null for none.
std::string average_table(const Group& group, const Figures& figures, const char* stopped = nullptr) {
  Cells head{"all scenes"};
  for (const Figure* f : figures) head.emplace_back(f->title);
  if (stopped) head.emplace_back(stopped);
  Table table(head);
  add_averages(table, group, figures, {}, stopped);
  return table.markdown();
}

/// A link to the CSV file of a table.
std::string elsewhere(const Data& data, const char* file) {
  const std::size_t others = data.groups.size() - main_groups(data).size();
  std::string out = "As a file, with a row per scan: [" + std::string(file) + "](" + data.folder + "/" + file + ")";
  if (others > 0) out += ", with the " + std::to_string(others) + " groups that are not shown here";
  return out + ".\n\n";
}

}  // namespace

std::string scanning_section(const Data& data) {
  using namespace figure;
  std::string out = "## Table 1: scanning\n\n";
  out +=
      "Views, points, computing time and shares of the fruit's surface, as in the paper's table of scanning and SOR. "
      "`scanned` is the share of the surface that is within 5 mm of any point of the cloud, `recall` the share within "
      "5 mm of a point of an instance, and `precision` the share of the points of instances that lie within 5 mm of a "
      "fruit.\n\n";
  out += picture(data, "scanning.svg", "Scanned percentage and recall per scene, ours and the paper's");
  out += elsewhere(data, "scanning.csv");
  out +=
      "After the paper's columns come our own. First table: the share of the surface that the arm can observe, and "
      "how much of it was covered; the precision over all points of the cloud, with stems and leaves, and at 2 mm; "
      "the number of views until 95 % of the observable surface had been seen. Second table: the length of the path "
      "in joint space, and its ratio to the shortest path through the same poses; the share of the points that region "
      "growing leaves to DBSCAN; by how many percentage points the planner's estimates of the scanned and of the "
      "observable share are off; and why the scans stopped.\n\n";
  for (const Group* group : main_groups(data)) {
    out += "### " + text(group->name()) + "\n\n";
    out += scene_table(*group, {&views, &merged, &filtered, &seconds, &scanned, &precision, &recall, &f1});
    out += "\nWhat the paper leaves out:\n\n";
    out += average_table(*group, {&observable, &recall_obs, &precision_all, &precision_strict, &views_95});
    out += "\n" +
           average_table(*group, {&path, &path_ratio, &residual, &belief_seen, &belief_observable}, "stopped by") +
           "\n";
  }
  return out;
}

std::string segmentation_section(const Data& data) {
  using namespace figure;
  std::string out = "## Table 2: segmentation\n\n";
  out +=
      "A detection is true if its surface IoU with a fruit is at least 0.5. The mIoU is given over the observable "
      "surface (in parentheses the paper's, which does not say how it was computed) and over the points of the cloud. "
      "N_real is the number of fruit of our scene; for one truss the paper states another number.\n\n";
  out += picture(data, "segmentation.svg", "Object recall and mIoU per scene, ours and the paper's");
  out += elsewhere(data, "segmentation.csv");
  for (const Group* group : main_groups(data)) {
    out += "### " + text(group->name()) + "\n\n";
    out += scene_table(*group, {&n_real, &n_det, &counting_error, &object_precision, &object_recall, &miou_surface,
                                &miou_point, &views_all});
    out +=
        "\nWhat each of the paper's two stages finds alone on the same clean cloud, a comparison that the paper "
        "omits:\n\n";
    out += average_table(*group, {&growing_n, &growing_recall, &growing_miou, &clustering_n, &clustering_recall,
                                  &clustering_miou}) +
           "\n";
  }
  return out;
}

}  // namespace agrisee::report
