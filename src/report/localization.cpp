// SPDX-License-Identifier: BSD-3-Clause
// Table 3: localization, and the errors of all fruit.
#include <agrisee/study/paper_tables.hpp>

#include "report/errors.hpp"
#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {
namespace {

using Cells = std::vector<std::string>;
using Points = std::vector<Eigen::Vector3d>;
using Error = std::optional<double> FruitMetrics::*;

constexpr double kMm = 1e3, kDegrees = 180.0 / kPi;

std::optional<Eigen::Vector3d> mean(const Points& points) {
  if (points.empty()) return std::nullopt;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : points) sum += p;
  return Eigen::Vector3d(sum / static_cast<double>(points.size()));
}

/// The mean coordinate along an axis and the mean standard deviation, over the trials.
std::string coordinate(const Points& at, const Points& sigma, int axis) {
  const auto p = mean(at), s = mean(sigma);
  return p ? fixed((*p)[axis], 3) + " ± " + fixed((*s)[axis], 3) : "-";
}
/// A coordinate of [1] with its standard deviation.
std::string coordinate(const std::array<double, 3>& at, const std::array<double, 3>& sigma, std::size_t axis) {
  return fixed(at[axis], 3) + " ± " + fixed(sigma[axis], 3);
}

/// The scene with the counts of the truss in the localization table of [1]; null if the group has none.
const Row* paper_row(const Group& group) {
  for (const Row& row : group.rows)
    if (row.total == study::kPaperLocalizationTotal && row.hidden == study::kPaperLocalizationHidden) return &row;
  return nullptr;
}

/// The fruit of a scene beside those of [1], in the world frame.
std::string fruit_table(const Row& row) {
  Cells head{"fruit", "located"};
  for (const char* name : {"x", "y", "z"}) head.push_back(std::string(name) + " ± σ (m)");
  for (const char* name : {"x", "y", "z"}) head.push_back("paper " + std::string(name));
  head.emplace_back("RMSE mm");
  Table table(head);
  for (const FruitTrials& fruit : fruit_trials(row)) {
    const study::PaperLocalization* paper = study::paper_localization(row.total, row.hidden, fruit.id);
    Cells cells{std::to_string(fruit.id) + (fruit.hidden ? ", hidden" : ""),
                std::to_string(fruit.world.size()) + " of " + std::to_string(fruit.trials)};
    for (int axis = 0; axis < 3; ++axis) cells.push_back(coordinate(fruit.world, fruit.sigma, axis));
    for (std::size_t axis = 0; axis < 3; ++axis)
      cells.push_back(paper ? coordinate(paper->world, paper->world_sigma, axis) : "-");
    cells.push_back(fixed(times(kMm, fruit.rmse()), 2) + (paper ? " (" + fixed(paper->rmse, 1) + ")" : ""));
    table.row(cells);
  }
  std::vector<double> of_paper;
  for (const auto& p : study::kPaperLocalization) of_paper.push_back(p.rmse);
  const Errors ours = repeatability(row), theirs = statistics(of_paper);
  for (const bool worst : {false, true}) {
    Cells cells(head.size(), "");
    cells[0] = worst ? "**worst**" : "**average**";
    cells.back() = fixed(times(kMm, worst ? ours.worst : ours.mean), 2) + " (" +
                   fixed(worst ? theirs.worst : theirs.mean, 1) + ")";
    table.row(cells);
  }
  return table.markdown();
}

/// A table with a row per scene and one for all scenes. f(row) and f(group) return the cells.
template <typename F>
std::string error_table(const Group& group, Cells head, F&& f) {
  head.insert(head.begin(), {"scene", "fruit / hidden"});
  Table table(head);
  const auto add = [&](const std::string& name, const std::string& counts, Cells cells) {
    cells.insert(cells.begin(), {name, counts});
    table.row(cells);
  };
  for (const Row& row : group.rows)
    add(text(row.scene), std::to_string(row.total) + " / " + std::to_string(row.hidden), f(row));
  add("**all**", "", f(group));
  return table.markdown();
}

/// The truss of the localization table of [1].
std::string paper_truss(const Group& group) {
  const Row* row = paper_row(group);
  if (!row)
    return "The truss of the paper's table (" + std::to_string(study::kPaperLocalizationTotal) + " fruit, " +
           std::to_string(study::kPaperLocalizationHidden) + " hidden) is not among the scenes.\n\n";
  return "The truss of the paper's table, here " + text(row->scene) +
         ", in the world frame (the base of the arm):\n\n" + fruit_table(*row) + "\n";
}

std::string distance_table(const Group& group) {
  return error_table(group,
                     {"missing", "RMSE", "centroid, observable", "centroid, seen", "fitted center", "radius",
                      "z axis deg", "completeness %", "least recall %"},
                     [](const auto& of) {
                       const auto mm = [&](Error error) {
                         const Errors e = errors(of, error);
                         return pair(times(kMm, e.mean), times(kMm, e.worst), 1);
                       };
                       const Errors rmse = repeatability(of), axis = errors(of, &FruitMetrics::axis_error),
                                    part = errors(of, &FruitMetrics::completeness_error);
                       return Cells{std::to_string(located(of).missing()),
                                    pair(times(kMm, rmse.mean), times(kMm, rmse.worst), 2),
                                    mm(&FruitMetrics::centroid_error),
                                    mm(&FruitMetrics::centroid_error_seen),
                                    mm(&FruitMetrics::center_error),
                                    mm(&FruitMetrics::radius_error),
                                    pair(times(kDegrees, axis.median), times(kDegrees, axis.worst), 1),
                                    pair(times(100.0, part.mean), times(100.0, part.worst), 1),
                                    fixed(times(100.0, least_recall(of)), 1)};
                     });
}

std::string group_section(const Group& group) {
  std::string out = "### " + text(group.name()) + "\n\n";
  const Located l = located(group);
  if (l.found == 0) return out + "None of " + std::to_string(l.all) + " fruit (counted once a scan) was located.\n\n";
  out += paper_truss(group);
  out += std::to_string(l.found) + " of " + std::to_string(l.all) +
         " fruit (counted once a scan) were located. Lengths in millimetres, `mean / worst` over fruit and trials:\n\n";
  return out + distance_table(group) + "\n";
}

}  // namespace

std::string localization_section(const Data& data) {
  std::string out = "## Table 3: localization\n\n";
  out +=
      "σ is the standard deviation of the points of a fruit along an axis. RMSE is the root mean square distance of "
      "the centroids of a fruit from their mean over the trials; the paper calls it repeatability. The truss of the "
      "paper's table has its fruit where the paper has them, except that fruit do not overlap and the last one is "
      "behind the others.\n\n";
  out += picture(data, "localization.svg",
                 "Repeatability per fruit, ours and the paper's, and errors of centroids per scene");
  out +=
      "Errors: the distance of the centroid from the mean of the observable surface of the fruit, and of the part of "
      "it that the views saw; the center and the radius of the fitted body; the angle between the z axis of the pose "
      "and the true calyx axis (`median / worst`); the completeness of the fitted body; and the least recall of the "
      "observable surface of any fruit, including missing ones.\n\n";
  for (const Group* group : main_groups(data)) out += group_section(*group);
  return out;
}

}  // namespace agrisee::report
