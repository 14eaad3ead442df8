// SPDX-License-Identifier: BSD-3-Clause
// The summary of all groups, beside the averages of the paper.
#include <agrisee/study/paper_tables.hpp>

#include <algorithm>

#include "report/errors.hpp"
#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {
namespace {

using Figures = std::vector<const Figure*>;
using Cells = std::vector<std::string>;

/// The scenes of all groups, without scans: the values of [1] are averaged over them.
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

/// The repeatability (m) of the truss in the localization table of [1].
Errors paper_rmse() {
  std::vector<double> values;
  for (const study::PaperLocalization& row : study::kPaperLocalization) values.push_back(1e-3 * row.rmse);
  return statistics(values);
}

/// `mean / worst` of errors in metres, shown in millimetres.
std::string millimetres(const Errors& e, int digits = 1) {
  return pair(times(1e3, e.mean), times(1e3, e.worst), digits);
}

/// The main figures of a group in one sentence.
std::string headline(const Group& group) {
  using namespace figure;
  const auto with_paper = [&](const Figure& f) {
    const auto paper = paper_mean(group, f);
    return fixed(mean(group, f).value, f.digits) + (paper ? " (" + fixed(paper, f.digits) + ")" : "");
  };
  const Errors rmse = repeatability(group);
  return "- **" + text(group.name()) + "**: R_obj " + with_paper(object_recall) + " %, P_obj " +
         with_paper(object_precision) + " %, mIoU " + with_paper(miou_surface) + " %, recall " + with_paper(recall) +
         " % of the whole and " + fixed(mean(group, recall_obs).value, 1) + " % of the observable surface, in " +
         with_paper(views) + " views and " + with_paper(seconds) + " s of computing time; " +
         (rmse.mean ? "the centroids repeat to " + fixed(1e3 * *rmse.mean, 2) + " (" +
                          fixed(1e3 * *paper_rmse().mean, 2) + ") mm.\n"
          : group.scans() > group.rows.size() ? "no fruit was located in two trials.\n"
                                              : "how well centroids repeat takes two trials to tell.\n");
}

/// The row of [1] in a table of these figures; `first` are the cells before them.
Cells paper_row(const Group& scenes, const Figures& figures, Cells first) {
  for (const Figure* f : figures) first.push_back(pair(paper_mean(scenes, *f), paper_worst(scenes, *f), f->digits));
  return first;
}

std::string scanning_table(const Data& data, const Group& paper_scenes) {
  using namespace figure;
  const Figures columns{&views, &seconds, &scanned, &precision, &recall, &f1, &recall_obs, &path};
  Cells head{"preset / planner / noise", "scans"};
  for (const Figure* f : columns) head.emplace_back(f->title);
  Table table(head);
  table.row(paper_row(paper_scenes, columns, {"**the paper**", "-"}));
  for (const Group& group : data.groups) {
    Cells cells{text(group.name()), std::to_string(group.scans())};
    for (const Figure* f : columns) cells.push_back(mean_and_worst(group, *f));
    table.row(cells);
  }
  return table.markdown();
}

std::string fruit_table(const Data& data, const Group& paper_scenes) {
  using namespace figure;
  const Figures columns{&counting_error, &object_precision, &object_recall, &miou_surface};
  Cells head{"preset / planner / noise"};
  for (const Figure* f : columns) head.emplace_back(f->title);
  for (const char* title : {"missing", "RMSE mm", "centroid mm", "fitted center mm", "z axis deg"})
    head.emplace_back(title);
  Table table(head);
  Cells paper = paper_row(paper_scenes, columns, {"**the paper**"});
  paper.insert(paper.end(), {"-", millimetres(paper_rmse(), 2), "-", "-", "-"});
  table.row(paper);
  for (const Group& group : data.groups) {
    Cells cells{text(group.name())};
    for (const Figure* f : columns) cells.push_back(mean_and_worst(group, *f));
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
    table.row(cells);
  }
  return table.markdown();
}

}  // namespace

std::string summary_section(const Data& data) {
  const Group paper_scenes = all_scenes(data);
  std::string out = "## Summary\n\n";
  for (const Group* group : main_groups(data)) out += headline(*group);
  out += "\nScanning:\n\n";
  out += scanning_table(data, paper_scenes);
  out +=
      "\nSegmentation and localization. Errors are `mean / worst` over the fruit that were matched to an instance; "
      "`missing` counts the others. The paper's RMSE is that of its one truss of " +
      std::to_string(study::kPaperLocalizationTotal) + ".\n\n";
  return out + fruit_table(data, paper_scenes) + "\n";
}

}  // namespace agrisee::report
