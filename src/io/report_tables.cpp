// SPDX-License-Identifier: BSD-3-Clause
// The paper's tables of scanning and segmentation, and the summary of all groups.
#include <agrisee/study/paper_tables.hpp>

#include <algorithm>

#include "report_data.hpp"

namespace agrisee::io::report {
namespace {

using Figures = std::vector<const Figure*>;
using Cells = std::vector<std::string>;

/// A row a scene, then the average, the worst row and the worst scan. `last` adds a column of words.
std::string figure_table(const Group& group, const Figures& figures, const char* last_title = nullptr) {
  Cells head{"scene", "fruit / hidden"};
  for (const Figure* f : figures) head.emplace_back(f->title);
  if (last_title) head.emplace_back(last_title);
  Table table(head);
  for (const Row& row : group.rows) {
    Cells cells{text(row.scene), std::to_string(row.total) + " / " + std::to_string(row.hidden)};
    for (const Figure* f : figures) {
      const auto paper = f->paper ? f->paper(row.total, row.hidden) : std::nullopt;
      cells.push_back(shown(mean(row, *f), f->digits, paper));
    }
    if (last_title) cells.push_back(stop_reasons(row));
    table.row(cells);
  }
  Cells average{"**average**", ""}, worst{"**worst row**", ""}, scan{"**worst scan**", ""};
  for (const Figure* f : figures) {
    const auto paper = paper_mean(group, *f);
    average.push_back(shown(mean(group, *f), f == &figure::n_real ? 1 : f->digits, paper));
    worst.push_back(shown({worst_row(group, *f), 0, 0}, f->digits, paper_worst(group, *f)));
    scan.push_back(fixed(worst_scan(group, *f), f->digits));
  }
  if (last_title) {
    average.push_back(stop_reasons(group));
    worst.emplace_back("");
    scan.emplace_back("");
  }
  table.row(average);
  table.row(worst);
  table.row(scan);
  return table.markdown();
}

std::string elsewhere(const Data& data, const char* file) {
  const std::size_t others = data.groups.size() - main_groups(data).size();
  std::string out = "One row per scan: [" + std::string(file) + "](" + data.folder + "/" + file + ")";
  if (others > 0) out += ", with the " + std::to_string(others) + " further groups that are not shown here";
  return out + ".\n\n";
}

/// The scenes of all groups, without scans: what the paper's figures are averaged over.
Group all_scenes(const Data& data) {
  Group all;
  for (const Group& group : data.groups)
    for (const Row& row : group.rows) {
      const auto same = [&](const Row& r) { return r.total == row.total && r.hidden == row.hidden; };
      if (std::none_of(all.rows.begin(), all.rows.end(), same))
        all.rows.push_back({row.scene, row.total, row.hidden, {}});
    }
  return all;
}

Errors paper_rmse() {
  std::vector<double> values;
  for (const study::PaperLocalization& row : study::kPaperLocalization) values.push_back(1e-3 * row.rmse);
  return statistics(values);
}

std::string millimetres(const Errors& e, int digits = 1) {
  const auto mm = [](const std::optional<double>& x) { return x ? std::optional(1e3 * *x) : std::nullopt; };
  return pair(mm(e.mean), mm(e.worst), digits);
}

}  // namespace

std::string summary_section(const Data& data) {
  using namespace figure;
  const Group paper_scenes = all_scenes(data);
  std::string out = "## Summary\n\n";
  for (const Group* group : main_groups(data)) {
    const auto with_paper = [&](const Figure& f) {
      const auto paper = paper_mean(*group, f);
      return fixed(mean(*group, f).value, f.digits) + (paper ? " (" + fixed(paper, f.digits) + ")" : "");
    };
    const Errors rmse = repeatability(*group);
    out += "- **" + text(group->name()) + "**: R_obj " + with_paper(object_recall) + " %, P_obj " +
           with_paper(object_precision) + " %, mIoU " + with_paper(miou_surface) + " %, recall " + with_paper(recall) +
           " % of the whole and " + fixed(mean(*group, recall_obs).value, 1) + " % of the observable surface, in " +
           with_paper(views) + " views and " + with_paper(seconds) + " s of computing; ";
    out += rmse.mean ? "centroids repeat to " + fixed(1e3 * *rmse.mean, 2) + " (" + fixed(1e3 * *paper_rmse().mean, 2) +
                           ") mm.\n"
                     : "no fruit was located in two trials.\n";
  }
  out +=
      "\nIn the tables each cell is `average / worst`: the mean over the scenes' rows, and the worst of these rows.\n\n"
      "Scanning:\n\n";
  const Figures scan{&views, &seconds, &scanned, &precision, &recall, &f1, &recall_obs, &path};
  Cells head{"preset / planner / noise", "scans"};
  for (const Figure* f : scan) head.emplace_back(f->title);
  Table scanning(head);
  Cells paper_row{"**the paper**", "-"};
  for (const Figure* f : scan)
    paper_row.push_back(pair(paper_mean(paper_scenes, *f), paper_worst(paper_scenes, *f), f->digits));
  scanning.row(paper_row);
  for (const Group& group : data.groups) {
    Cells cells{text(group.name()), std::to_string(group.scans())};
    for (const Figure* f : scan) cells.push_back(pair(mean(group, *f).value, worst_row(group, *f), f->digits));
    scanning.row(cells);
  }
  out += scanning.markdown();
  out +=
      "\nSegmentation and localisation. Errors of fruit are `mean / worst` over all fruit of all scans that were "
      "matched to an instance; `missing` says how many were not. The paper's RMSE is that of its one truss of " +
      std::to_string(study::kPaperLocalizationTotal) + ".\n\n";
  const Figures split{&counting_error, &object_precision, &object_recall, &miou_surface};
  head = {"preset / planner / noise"};
  for (const Figure* f : split) head.emplace_back(f->title);
  for (const char* title : {"missing", "RMSE mm", "centroid mm", "fitted centre mm", "z axis deg"})
    head.emplace_back(title);
  Table located_table(head);
  paper_row = {"**the paper**"};
  for (const Figure* f : split)
    paper_row.push_back(pair(paper_mean(paper_scenes, *f), paper_worst(paper_scenes, *f), f->digits));
  paper_row.insert(paper_row.end(), {"-", millimetres(paper_rmse(), 2), "-", "-", "-"});
  located_table.row(paper_row);
  for (const Group& group : data.groups) {
    Cells cells{text(group.name())};
    for (const Figure* f : split) cells.push_back(pair(mean(group, *f).value, worst_row(group, *f), f->digits));
    const Located l = located(group);
    const Errors axis = errors(group, &FruitMetrics::axis_error);
    const auto degrees = [](const std::optional<double>& x) {
      return x ? std::optional(*x * 180.0 / kPi) : std::nullopt;
    };
    cells.push_back(std::to_string(l.missing()) + " of " + std::to_string(l.all));
    cells.push_back(millimetres(repeatability(group), 2));
    cells.push_back(millimetres(errors(group, &FruitMetrics::centroid_error)));
    cells.push_back(millimetres(errors(group, &FruitMetrics::center_error)));
    cells.push_back(pair(degrees(axis.mean), degrees(axis.worst), 1));
    located_table.row(cells);
  }
  return out + located_table.markdown() + "\n";
}

std::string scanning_section(const Data& data) {
  using namespace figure;
  std::string out = "## Table 1: scanning\n\n";
  out +=
      "Views, points, computing time and the shares of the fruit's surface, as in the paper's table of scanning and "
      "SOR. "
      "`scanned` counts any point, `recall` only points of an instance, `precision` the points of instances that lie "
      "on a fruit, all within 5 mm.\n\n";
  out += picture(data, "scanning.svg", "Scanned percentage and recall per scene, ours and the paper's");
  out += elsewhere(data, "scanning.csv");
  for (const Group* group : main_groups(data)) {
    out += "### " + text(group->name()) + "\n\n";
    out += figure_table(*group, {&views, &merged, &filtered, &seconds, &scanned, &precision, &recall, &f1});
    out +=
        "\nWhat the paper leaves out: how much of the surface the arm can observe at all, and how much of that was "
        "covered; precision over all points of the cloud, stems and leaves included, and at 2 mm; views until 95 % of "
        "the observable surface had been seen; the path through joint space and its ratio to the shortest path "
        "through the same poses; the share of points that region growing leaves to DBSCAN; and how far the planner's "
        "own "
        "belief of what it has scanned, and of what the arm can see at all, is from the truth, in percentage "
        "points.\n\n";
    out += figure_table(*group, {&observable, &recall_obs, &precision_all, &precision_strict, &views_95});
    out += "\n" +
           figure_table(*group, {&path, &path_ratio, &residual, &belief_seen, &belief_observable}, "stopped by") + "\n";
  }
  return out;
}

std::string segmentation_section(const Data& data) {
  using namespace figure;
  std::string out = "## Table 2: segmentation\n\n";
  out +=
      "A detection is true when its surface IoU with a fruit is at least 0.5. mIoU is given over the observable "
      "surface "
      "(beside it the paper's, which does not say how it was computed) and over the points of the cloud. Fruit are the "
      "scene's own: where the paper's row counts another number, its N_real is what the parentheses show.\n\n";
  out += picture(data, "segmentation.svg", "Object recall and mIoU per scene, ours and the paper's");
  out += elsewhere(data, "segmentation.csv");
  for (const Group* group : main_groups(data)) {
    out += "### " + text(group->name()) + "\n\n";
    out += figure_table(*group, {&n_real, &n_det, &counting_error, &object_precision, &object_recall, &miou_surface,
                                 &miou_point, &views_all});
    out +=
        "\nWhat each of the paper's two stages finds alone on the same clean cloud, a comparison that the paper "
        "omits:\n\n";
    out += figure_table(*group, {&growing_n, &growing_recall, &growing_miou, &clustering_n, &clustering_recall,
                                 &clustering_miou}) +
           "\n";
  }
  return out;
}

}  // namespace agrisee::io::report
