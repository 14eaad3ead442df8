// SPDX-License-Identifier: BSD-3-Clause
// Where the paper contradicts itself, with the figures that show it computed from its own tables and parameters.
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/see/params.hpp>
#include <agrisee/study/paper_tables.hpp>

#include <Eigen/Geometry>

#include <algorithm>

#include "report_data.hpp"

namespace agrisee::io::report {
namespace {

/// Mean of a column of one of the paper's tables.
template <typename Table, typename Member>
double mean_of(const Table& table, Member member) {
  double sum = 0.0;
  for (const auto& row : table) sum += static_cast<double>(row.*member);
  return sum / static_cast<double>(table.size());
}

template <typename Table, typename Member>
double least_of(const Table& table, Member member) {
  double least = static_cast<double>(table[0].*member);
  for (const auto& row : table) least = std::min(least, static_cast<double>(row.*member));
  return least;
}

/// Points of a flat hexagonal lattice within `radius` of one of them, itself included: no flat surface whose points
/// keep the distance `spacing` holds more around a point of that lattice.
int lattice_points(double radius, double spacing) {
  const double reach = radius / spacing;
  const int n = static_cast<int>(reach) * 2;
  int count = 0;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j) count += i * i + i * j + j * j <= reach * reach;
  return count;
}

/// The largest distance of a cluster column of the localisation table from what its world column becomes under the
/// rigid motion that fits all of them best (Kabsch).
double worst_rigid_residual() {
  using namespace study;
  constexpr int n = static_cast<int>(kPaperLocalization.size());
  Eigen::Matrix<double, 3, n> world, cluster;
  for (int i = 0; i < n; ++i) {
    const PaperLocalization& row = kPaperLocalization[static_cast<std::size_t>(i)];
    world.col(i) = Eigen::Map<const Eigen::Vector3d>(row.world.data());
    cluster.col(i) = Eigen::Map<const Eigen::Vector3d>(row.cluster.data());
  }
  const Eigen::Matrix4d motion = Eigen::umeyama(world, cluster, false);
  double worst = 0.0;
  for (int i = 0; i < n; ++i)
    worst = std::max(worst, ((motion * world.col(i).homogeneous()).head<3>() - cluster.col(i)).norm());
  return worst;
}

}  // namespace

std::string contradictions_section(const Data& data) {
  using namespace study;
  const see::Parameters see = see::Parameters::paper();
  const DbscanParameters db = DbscanParameters::paper();
  const RegionGrowingParameters growing = RegionGrowingParameters::paper();
  const PaperText& t = kPaperText;
  const double epsilon = see.min_separation();
  const double residual = 100.0 * (t.residual_cloud - t.residual_grown) / t.residual_cloud;
  double fewest = 1e9, most = 0.0;
  for (const PaperScanning& row : kPaperScanning) {
    const double kept = 100.0 * row.filtered / row.merged;
    fewest = std::min(fewest, kept);
    most = std::max(most, kept);
  }
  std::string out = "## Where the paper contradicts itself, and what follows\n\n";
  const auto item = [&](const std::string& what, const std::string& says) {
    out += "- **" + what + "** " + says + "\n";
  };
  item(
      "When a scan stops.",
      "Its text asks for a minimum density, its algorithm for a maximum; one outlier or one dense spot would decide. A "
      "scan "
      "here stops when no frontier is left that the arm can observe, when the expected gain is too low, or at the view "
      "budget, and says which.");
  item("τ.",
       "The letter stands for the number of frontiers that are updated in a step in SEE++, for the largest number of "
       "views "
       "in the paper's parameters, and for the views taken in its results. Here these are `see.max_updates`, "
       "`max_views` "
       "and the views of the result.");
  item("ε has the wrong dimension.",
       "SEE++'s minimum separation (3r / 2πρ)^(1/3) is not a length; with the paper's r and ρ its value is " +
           fixed(1e3 * epsilon, 2) +
           " mm, which the `paper` preset keeps. The default derives its spacing from the sensor.");
  item("What counts as dense.",
       "The neighbourhood of " + fixed(1e3 * see.radius, 0) + " mm, in which " + std::to_string(see.k()) +
           " points make a core point, is as large as a fruit: a gap smaller than a fruit never becomes a frontier.");
  item("The test of normals",
       "asks that a frontier's normal point away from the cloud's mean. In a truss, which is concave, that discards "
       "just the "
       "frontiers that look into the gaps between fruit. It is an option, on in the `paper` preset only.");
  item("Outlier removal",
       "at two standard deviations is said to keep 95.4 %, but only one tail is cut, which keeps 97.7 % of a Gaussian; "
       "its table "
       "keeps " +
           fixed(fewest, 1) + " to " + fixed(most, 1) +
           " %, as filtering after every view would. The `paper` preset "
           "filters after every view.");
  item("DBSCAN cannot fire on a clean cloud.",
       std::to_string(db.min_points) + " points within " + fixed(1e3 * db.eps, 0) +
           " mm are asked for; the densest flat lattice with " + fixed(1e3 * epsilon, 2) + " mm between points holds " +
           std::to_string(lattice_points(db.eps, epsilon)) +
           ". Only noise, or surfaces that touch, reach it. Table 2 shows what it finds alone.");
  item("The residual.",
       "Of " + std::to_string(t.residual_cloud) + " points region growing is said to take " +
           std::to_string(t.residual_grown) + " in 7 clusters of some " + std::to_string(t.residual_per_instance) +
           ", and to leave " + fixed(residual, 1) + " %. Seven clusters would hold " +
           fixed(t.residual_grown / 7.0, 0) + " each, six " + fixed(t.residual_grown / 6.0, 0) +
           "; the table's cloud of seven fruit with one hidden has " +
           std::to_string(paper_scanning(kPaperLocalizationTotal, kPaperLocalizationHidden)->filtered) +
           " points. The share left is measured in table 1. DBSCAN runs when the residual has more than N_hidden "
           "points, for which "
           "the paper gives no value; here that is N_min, " +
           std::to_string(growing.min_size) + ".");
  item("Noise.",
       "A standard deviation of 10 mm is called the sensor's nominal value. The published figure is 2.5 mm at 1 m; 10 "
       "mm is the "
       "default of SEE++'s simulation, and more than the 6 mm neighbourhoods in which normals are estimated. Hence "
       "several noise "
       "models here.");
  item("View distance and reach.",
       "Views stand at " + fixed(see.view_distance, 2) +
           " m from the frontier; a UR3 at this place cannot stand straight in "
           "front of the truss at any distance that the sensor allows, since its wrist is offset. Here distance and "
           "roll are free "
           "within the sensor's range, and the first view is the reachable one nearest to frontal.");
  const PaperSegmentation& first = kPaperSegmentation[0];
  item("A row with one fruit too many.",
       "The truss of " + std::to_string(first.total) + " fruit with " + std::to_string(first.hidden) +
           " hidden has N_real = " + std::to_string(first.n_real) + " and N_det = " + std::to_string(first.n_det) +
           ". The scene here has " + std::to_string(first.total) + ".");
  double rmse = 0.0;
  for (const PaperLocalization& row : kPaperLocalization)
    rmse += row.rmse / static_cast<double>(kPaperLocalization.size());
  item("Averages.",
       "The tables give a mean recall of " + fixed(mean_of(kPaperScanning, &PaperScanning::recall), 2) +
           " %, the abstract " + fixed(t.abstract_recall, 1) + " %, which its text gives as R_obj (table: " +
           fixed(mean_of(kPaperSegmentation, &PaperSegmentation::object_recall), 1) + " %); a mean mIoU of " +
           fixed(mean_of(kPaperSegmentation, &PaperSegmentation::miou), 1) + " %, the abstract " +
           fixed(t.abstract_miou, 1) + " %; a mean RMSE of " + fixed(rmse, 1) + " mm, the abstract " +
           fixed(t.abstract_rmse, 1) + " mm. Precision is said to stay above " + fixed(t.conclusion_precision, 1) +
           " %; the table's least is " + fixed(least_of(kPaperScanning, &PaperScanning::precision), 1) +
           " %, its mean " + fixed(mean_of(kPaperScanning, &PaperScanning::precision), 1) +
           " %. Here all averages are computed from the tables, " + "also those of " +
           fixed(mean_of(kPaperScanning, &PaperScanning::views), 1) + " views and " +
           fixed(mean_of(kPaperScanning, &PaperScanning::seconds), 1) + " s.");
  item("Two frames that do not agree.",
       "The cluster columns of the localisation table follow from its world columns by no rigid motion: the best one "
       "leaves a "
       "fruit " +
           fixed(1e3 * worst_rigid_residual(), 0) +
           " mm away. Only the world columns are compared. Its seventh fruit lies "
           "below the others, where nothing would hide it; here it is behind them.");
  item("Centroid.",
       "The mean of a fruit's points lies between its surface and its centre, up to half a radius off where only a "
       "cap was seen; repeatability does not show that. Table 3 adds errors against the truth, and those of a "
       "fitted body.");
  const std::vector<const Group*> main = main_groups(data);
  std::string measured;
  for (const Group* group : main)
    measured += (measured.empty() ? "" : "; ") + text(group->name()) + ": residual " +
                fixed(mean(*group, figure::residual).value, 1) + " %, region growing alone R_obj " +
                fixed(mean(*group, figure::growing_recall).value, 1) + " %, DBSCAN alone " +
                fixed(mean(*group, figure::clustering_recall).value, 1) + " %, the whole " +
                fixed(mean(*group, figure::object_recall).value, 1) + " %";
  item("The comparison that was left out.",
       "The paper considers it unnecessary to compare its pipeline with a single algorithm. Averages here: " +
           measured + ".");
  return out;
}

}  // namespace agrisee::io::report
