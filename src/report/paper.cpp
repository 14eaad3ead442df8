// SPDX-License-Identifier: BSD-3-Clause
// The figures in which the tables, the text and the parameters of [1] contradict each other. docs/paper.md discusses
// them.
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/see/parameters.hpp>
#include <agrisee/study/paper_tables.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {
namespace {

constexpr double kStatedInliers = 95.4;  // share of the points that SOR keeps, as stated in section 2.2.2 of [1] (%)

/// The values of a column of one of the tables of [1].
template <typename Table, typename Member>
std::vector<double> column(const Table& table, Member member) {
  std::vector<double> values;
  for (const auto& row : table) values.push_back(static_cast<double>(row.*member));
  return values;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double least_of(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }
double most_of(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

/// The shares of the points that outlier removal keeps in the scanning table (%).
std::vector<double> kept_by_sor() {
  std::vector<double> shares;
  for (const study::PaperScanning& row : study::kPaperScanning) shares.push_back(100.0 * row.filtered / row.merged);
  return shares;
}

/// The number of points of a flat hexagonal lattice within `radius` of one of its points, this point included. On a
/// flat surface whose points keep the distance `spacing`, no point has more neighbors.
int lattice_points(double radius, double spacing) {
  const double reach = radius / spacing;
  const int n = static_cast<int>(reach) * 2;
  int count = 0;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j) count += i * i + i * j + j * j <= reach * reach;
  return count;
}

/// The rigid motion that takes the world columns of the localization table nearest to its cluster columns (least
/// squares; Umeyama, 1991). @return the largest distance that is left (m)
double worst_rigid_residual() {
  constexpr int n = static_cast<int>(study::kPaperLocalization.size());
  Eigen::Matrix<double, 3, n> world, cluster;
  for (int i = 0; i < n; ++i) {
    const study::PaperLocalization& row = study::kPaperLocalization[static_cast<std::size_t>(i)];
    world.col(i) = Eigen::Map<const Eigen::Vector3d>(row.world.data());
    cluster.col(i) = Eigen::Map<const Eigen::Vector3d>(row.cluster.data());
  }
  const Eigen::Matrix4d motion = Eigen::umeyama(world, cluster, false);
  double worst = 0.0;
  for (int i = 0; i < n; ++i)
    worst = std::max(worst, ((motion * world.col(i).homogeneous()).head<3>() - cluster.col(i)).norm());
  return worst;
}

void add_averages(Table& table) {
  using namespace study;
  const PaperText& stated = kPaperText;
  const std::vector<double> precision = column(kPaperScanning, &PaperScanning::precision);
  const auto row = [&](const std::string& what, double computed, int digits, std::optional<double> said) {
    table.row({what, fixed(computed, digits), fixed(said, 1)});
  };
  row("mean recall %", mean_of(column(kPaperScanning, &PaperScanning::recall)), 2, stated.abstract_recall);
  row("mean R_obj %", mean_of(column(kPaperSegmentation, &PaperSegmentation::object_recall)), 1,
      stated.text_object_recall);
  row("mean mIoU %", mean_of(column(kPaperSegmentation, &PaperSegmentation::miou)), 1, stated.abstract_miou);
  row("mean RMSE mm", mean_of(column(kPaperLocalization, &PaperLocalization::rmse)), 1, stated.abstract_rmse);
  row("least precision %", least_of(precision), 1, stated.conclusion_precision);
  row("mean precision %", mean_of(precision), 1, std::nullopt);
  row("mean number of views", mean_of(column(kPaperScanning, &PaperScanning::views)), 1, std::nullopt);
  row("mean computing time s", mean_of(column(kPaperScanning, &PaperScanning::seconds)), 1, std::nullopt);
}

void add_stages(Table& table) {
  const study::PaperText& stated = study::kPaperText;
  const see::Parameters see = see::Parameters::paper();
  const DbscanParameters dbscan = DbscanParameters::paper();
  const double epsilon = see.min_separation();
  const auto count = [](double n) { return fixed(n, 0); };
  table.row({"points kept by SOR, least %", fixed(least_of(kept_by_sor()), 1), fixed(kStatedInliers, 1)});
  table.row({"points kept by SOR, most %", fixed(most_of(kept_by_sor()), 1), fixed(kStatedInliers, 1)});
  table.row({"share of a Gaussian below its mean + 2 σ %", fixed(50.0 * std::erfc(-std::sqrt(2.0)), 1),
             fixed(kStatedInliers, 1)});
  table.row({"points of the filtered cloud, 7 fruit, 1 hidden",
             count(study::paper_scanning(study::kPaperLocalizationTotal, study::kPaperLocalizationHidden)->filtered),
             count(stated.residual_cloud)});
  table.row({"points left by region growing %",
             fixed(100.0 * (stated.residual_cloud - stated.residual_grown) / stated.residual_cloud, 1), "-"});
  for (const int clusters : {7, 6})
    table.row({"points per instance, " + std::to_string(clusters) + " clusters",
               count(static_cast<double>(stated.residual_grown) / clusters), count(stated.residual_per_instance)});
  table.row({"minimum separation ε mm", fixed(1e3 * epsilon, 2), "-"});
  table.row({"points within r that make a core point", std::to_string(see.k()), "-"});
  table.row({"points within " + count(1e3 * dbscan.eps) + " mm on a flat lattice of spacing ε",
             std::to_string(lattice_points(dbscan.eps, epsilon)), std::to_string(dbscan.min_points)});
}

void add_inconsistent_rows(Table& table) {
  const study::PaperSegmentation& first = study::kPaperSegmentation[0];
  table.row(
      {"fruit of the truss with " + std::to_string(first.total) + " fruit, " + std::to_string(first.hidden) + " hidden",
       std::to_string(first.total), std::to_string(first.n_real)});
  table.row({"distance left by the best rigid motion from world to cluster columns mm",
             fixed(1e3 * worst_rigid_residual(), 0), "0"});
}

}  // namespace

std::string paper_section() {
  Table table({"quantity", "computed", "stated"});
  add_averages(table);
  add_stages(table);
  add_inconsistent_rows(table);
  return "## The paper's figures, recomputed\n\n"
         "Where the paper contradicts itself (docs/paper.md): what follows from its tables and parameters, and what "
         "its text, or another table, states or requires.\n\n" +
         table.markdown();
}

}  // namespace agrisee::report
