// SPDX-License-Identifier: BSD-3-Clause
// The paper's table of localisation, and the errors of all fruit.
#include <agrisee/study/paper_tables.hpp>

#include "report_data.hpp"

namespace agrisee::io::report {
namespace {

using Cells = std::vector<std::string>;
using Points = std::vector<Eigen::Vector3d>;
using Error = std::optional<double> FruitMetrics::*;

std::optional<double> times(double factor, const std::optional<double>& x) {
  return x ? std::optional(factor * *x) : std::nullopt;
}
constexpr double kMm = 1e3, kDegrees = 180.0 / kPi;

std::optional<Eigen::Vector3d> mean(const Points& points) {
  if (points.empty()) return std::nullopt;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : points) sum += p;
  return Eigen::Vector3d(sum / static_cast<double>(points.size()));
}

std::string coordinate(const Points& at, const Points& sigma, int axis) {
  const auto p = mean(at), s = mean(sigma);
  return p ? fixed((*p)[axis], 3) + " ± " + fixed((*s)[axis], 3) : "-";
}
std::string coordinate(const std::array<double, 3>& at, const std::array<double, 3>& sigma, std::size_t axis) {
  return fixed(at[axis], 3) + " ± " + fixed(sigma[axis], 3);
}

/// The scene that the paper's table shows, if the group has it.
const Row* paper_row(const Group& group) {
  for (const Row& row : group.rows)
    if (row.total == study::kPaperLocalizationTotal && row.hidden == study::kPaperLocalizationHidden) return &row;
  return nullptr;
}

/// Every fruit of a scene in one of the two frames.
std::string fruit_table(const Row& row, bool world) {
  Cells head{"fruit", "located"};
  for (const char* name : {"x", "y", "z"}) head.push_back(std::string(name) + " ± σ (m)");
  for (const char* name : {"x", "y", "z"}) head.push_back("paper " + std::string(name));
  if (world) head.emplace_back("RMSE mm");
  Table table(head);
  for (const FruitTrials& fruit : fruit_trials(row)) {
    const study::PaperLocalization* paper = study::paper_localization(row.total, row.hidden, fruit.id);
    Cells cells{std::to_string(fruit.id) + (fruit.hidden ? ", hidden" : ""),
                std::to_string(fruit.world.size()) + " of " + std::to_string(fruit.trials)};
    for (int axis = 0; axis < 3; ++axis)
      cells.push_back(coordinate(world ? fruit.world : fruit.cluster, fruit.sigma, axis));
    for (std::size_t axis = 0; axis < 3; ++axis)
      cells.push_back(!paper  ? "-"
                      : world ? coordinate(paper->world, paper->world_sigma, axis)
                              : coordinate(paper->cluster, paper->cluster_sigma, axis));
    if (world) cells.push_back(fixed(times(kMm, fruit.rmse()), 2) + (paper ? " (" + fixed(paper->rmse, 1) + ")" : ""));
    table.row(cells);
  }
  if (world) {
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
  }
  return table.markdown();
}

/// A row a scene and one for all: `f` gives the cells of a Row or Group.
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

}  // namespace

std::string localization_section(const Data& data) {
  std::string out = "## Table 3: localisation\n\n";
  out +=
      "Fruit are followed by the true fruit that an instance was matched to. σ is the standard deviation of a fruit's "
      "points along an axis; it is the same in both frames, whose axes are parallel. RMSE is the root of the mean "
      "squared "
      "distance of a fruit's centroids from their mean over the trials, the paper's repeatability.\n\n";
  out += picture(data, "localization.svg",
                 "Repeatability per fruit, ours and the paper's, and errors of centroids per scene");
  out += "One row per scan: [localization.csv](" + data.folder +
         "/localization.csv); one row per fruit and scan: [fruits.csv](" + data.folder + "/fruits.csv).\n\n";
  for (const Group* group : main_groups(data)) {
    out += "### " + text(group->name()) + "\n\n";
    const Located l = located(*group);
    if (l.found == 0) {
      out += "None of " + std::to_string(l.all) + " fruit (counted once a scan) was located.\n\n";
      continue;
    }
    if (const Row* row = paper_row(*group)) {
      out +=
          "The truss of the paper's table, here " + text(row->scene) +
          ", in world (the arm's base). This project's scene of it has the paper's world centres as far as fruit do "
          "not "
          "interpenetrate, and its last fruit behind the others:\n\n" +
          fruit_table(*row, true) +
          "\nThe same in the cluster frame, whose origin is the scan volume's lower left far "
          "corner. The paper's columns are not comparable: they follow from its world columns by no rigid motion.\n\n" +
          fruit_table(*row, false) + "\n";
    } else {
      out += "The truss of the paper's table (" + std::to_string(study::kPaperLocalizationTotal) + " fruit, " +
             std::to_string(study::kPaperLocalizationHidden) + " hidden) is not among the scenes.\n\n";
    }
    out += std::to_string(l.found) + " of " + std::to_string(l.all) + " fruit (counted once a scan) were located, " +
           std::to_string(l.missing()) +
           " are missing from the rows below. All in millimetres, `mean / worst` over fruit and "
           "trials: the repeatability; the centroid's distance from the mean of the fruit's observable surface and "
           "from the "
           "mean of what the views taken saw of it; the fitted body's centre and radius against the true ones.\n\n";
    out += error_table(
        *group, {"missing", "RMSE", "centroid, observable", "centroid, seen", "fitted centre", "radius"},
        [](const auto& of) {
          const auto mm = [&](Error error) {
            const Errors e = errors(of, error);
            return pair(times(kMm, e.mean), times(kMm, e.worst), 1);
          };
          const Errors rmse = repeatability(of);
          return Cells{std::to_string(located(of).missing()), pair(times(kMm, rmse.mean), times(kMm, rmse.worst), 2),
                       mm(&FruitMetrics::centroid_error),     mm(&FruitMetrics::centroid_error_seen),
                       mm(&FruitMetrics::center_error),       mm(&FruitMetrics::radius_error)};
        });
    out +=
        "\nThe angle between the pose's z axis and the true calyx axis (`median / worst`, degrees), the error of the "
        "fitted body's completeness (`mean / worst`, percentage points), and the least share of its observable surface "
        "that any fruit got, missing fruit included:\n\n";
    out +=
        error_table(*group, {"z axis deg", "completeness", "least fruit's recall, observable %"}, [](const auto& of) {
          const Errors axis = errors(of, &FruitMetrics::axis_error),
                       part = errors(of, &FruitMetrics::completeness_error);
          return Cells{pair(times(kDegrees, axis.median), times(kDegrees, axis.worst), 1),
                       pair(times(100.0, part.mean), times(100.0, part.worst), 1),
                       fixed(times(100.0, least_recall(of)), 1)};
        });
    out += "\n";
  }
  return out;
}

}  // namespace agrisee::io::report
