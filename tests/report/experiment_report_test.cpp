// SPDX-License-Identifier: BSD-3-Clause
#include "report/experiment_report.hpp"

#include <agrisee/study/paper_tables.hpp>

#include <algorithm>
#include <limits>
#include <map>
#include <sstream>

#include "io/io_support.hpp"
#include "support/says.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace {

/// A scan of a truss whose last fruit is found only if `all` is true.
study::CellRecord cell(const std::string& scene, int total, int hidden, int trial, bool all = true) {
  study::CellRecord r;
  r.cell.scene = scene;
  r.cell.noise = "l515";
  r.cell.trial = trial;
  r.total = total;
  r.hidden = hidden;
  r.stop_reason = trial == 1 ? "low_gain" : "max_views";
  r.views = 3;
  r.merged = 4000;
  r.filtered = 2000;
  r.residual = 500;
  r.seconds.total = 2.5;
  r.path = 6.0;
  r.shortest_path = 4.0;
  r.metrics.recall = 0.5;
  r.metrics.n_real = total;
  r.metrics.n_det = r.metrics.n_true = all ? total : total - 1;
  r.metrics.counting_error = total - r.metrics.n_det;
  r.metrics.object_precision = 1.0;
  r.metrics.object_recall = static_cast<double>(r.metrics.n_true) / total;
  r.recall_after = r.scanned_after = {0.5, 0.95, 0.97};
  r.true_after = {1, r.metrics.n_true, r.metrics.n_true};
  for (int id = 1; id <= total; ++id) {
    study::FruitMetrics f;
    study::LocatedFruit l;
    f.id = l.id = id;
    l.hidden = id > total - hidden;
    f.recall_obs = 0.9;
    if (all || id < total) {
      f.instance = id;
      l.found_by = "region_growing";
      l.centroid = {0.1 * id, 0.5, 0.2};
      l.centroid_cluster = l.centroid - Eigen::Vector3d(0.0, 0.4, 0.1);
      l.sigma = {0.01, 0.02, 0.03};
      f.centroid_error = 0.001 * id;
    }
    r.metrics.fruits.push_back(f);
    r.fruits.push_back(l);
  }
  return r;
}

study::SceneRecord scene(const std::string& name, int total, int hidden) {
  study::SceneRecord s;
  s.scene = name;
  s.total = total;
  s.hidden = hidden;
  s.observable = 0.72;
  s.observable_least = 0.625;
  s.hidden_share_most = 0.125;
  s.views_90 = 4;
  return s;
}

/// Rows of a CSV file without quoted cells, as maps from column to text.
std::vector<std::map<std::string, std::string>> read_table(const std::filesystem::path& path) {
  std::istringstream in(slurp(path));
  const auto split = [](const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char c : line)
      if (c == ',')
        cells.emplace_back();
      else
        cells.back() += c;
    return cells;
  };
  std::string line;
  std::getline(in, line);
  const auto head = split(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(in, line)) {
    const auto cells = split(line);
    REQUIRE(cells.size() == head.size());
    rows.emplace_back();
    for (std::size_t i = 0; i < head.size(); ++i) rows.back()[head[i]] = cells[i];
  }
  return rows;
}

/// The cells of the first table row after `section` that begins with `first`.
std::vector<std::string> find_row(const std::string& document, const std::string& section, const std::string& first) {
  const auto from = document.find(section);
  REQUIRE(from != std::string::npos);
  const auto at = document.find("\n| " + first + " ", from);
  REQUIRE(at != std::string::npos);
  std::istringstream line(document.substr(at + 2, document.find('\n', at + 1) - at - 2));
  std::vector<std::string> cells;
  for (std::string cell; std::getline(line, cell, '|');) {
    const auto begin = cell.find_first_not_of(' ');
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, cell.find_last_not_of(' ') - begin + 1));
  }
  return cells;
}

const report::ReportInfo kInfo{"1.2.3", "agrisee experiment -o out"};

}  // namespace

TEST_CASE("the paper's tables are found by counts and give its averages") {
  REQUIRE(study::paper_scanning(7, 1));
  CHECK(study::paper_scanning(7, 1)->views == 12);
  CHECK(study::paper_segmentation(5, 1)->n_real == 6);
  CHECK_FALSE(study::paper_scanning(7, 4));
  CHECK_FALSE(study::paper_segmentation(4, 1));
  CHECK(study::paper_localization(7, 1, 7)->rmse == 5.6);
  CHECK_FALSE(study::paper_localization(7, 2, 7));
  CHECK_FALSE(study::paper_localization(7, 1, 8));
  double recall = 0.0, miou = 0.0;
  for (const auto& row : study::kPaperScanning) recall += row.recall / 11.0;
  for (const auto& row : study::kPaperSegmentation) miou += row.miou / 11.0;
  CHECK(recall == Approx(72.05).margin(0.005));
  CHECK(miou == Approx(study::kPaperText.table_miou).margin(0.05));
}

TEST_CASE("means, worst rows and repeatability are what they are by hand") {
  const TempFolder folder;
  std::vector<study::CellRecord> cells{cell("a", 6, 2, 1), cell("a", 6, 2, 2), cell("own", 4, 0, 1),
                                       cell("own", 4, 0, 2)};
  cells[0].metrics.recall = 0.6;  // with 0.5: mean 55, worst scan 50
  cells[2].metrics.recall = 0.9;
  cells[3].metrics.recall = 0.8;                                    // mean 85; of both scenes 70
  cells[1].fruits[0].centroid += Eigen::Vector3d(0.0, 0.004, 0.0);  // 2 mm from the mean of two: RMSE 2 mm
  cells[3].scanned_after = {0.5, 0.9, 0.94};
  report::write_experiment_report(folder / "report.md", cells, {scene("a", 6, 2)}, kInfo);
  const std::string document = slurp(folder / "report.md");

  // Columns: scene, counts, views, merged, after SOR, seconds, scanned, precision, recall, F1.
  CHECK(find_row(document, "## Table 1", "a").at(8) == "55.0 (81.2)");
  CHECK(find_row(document, "## Table 1", "a").at(2) == "3.0 (7.0)");
  CHECK(find_row(document, "## Table 1", "own").at(8) == "85.0");
  CHECK(find_row(document, "## Table 1", "**average**").at(8) == "70.0 (81.2)");
  CHECK(find_row(document, "## Table 1", "**worst row**").at(8) == "55.0 (81.2)");
  CHECK(find_row(document, "## Table 1", "**worst scan**").at(8) == "50.0");
  // After 3, 12, 20 and 50 views, views to 95 %, share, path, planning, stopped by.
  const auto planner = find_row(document, "## Planners", "default / gain / l515");
  CHECK(planner.at(5) == "2.0 [3/4]");
  CHECK(planner.at(7).rfind("1.50", 0) == 0);
  CHECK(planner.back() == "low_gain 2, max_views 2");
  // Observable share, precision of all points, and at 2 mm, residual.
  CHECK(find_row(document, "What the paper leaves out", "default / gain / l515").at(4) == "25.0 / -");

  const auto rows = read_table(folder / "report/scanning.csv");
  REQUIRE(rows.size() == 4);
  CHECK(rows[0].at("scene") == "own");  // by fruit
  CHECK(rows[2].at("recall_pct") == "60");
  CHECK(rows[2].at("paper_recall_pct") == "81.2");
  CHECK(rows[0].at("paper_recall_pct").empty());
  CHECK(rows[0].at("views_to_95pct") == "2");
  CHECK(rows[1].at("views_to_95pct").empty());
  CHECK(rows[0].at("points_merged") == "4000");
  CHECK(rows[0].at("residual_pct") == "25");
  CHECK(rows[0].at("path_ratio") == "1.5");

  const auto fruits = read_table(folder / "report/fruits.csv");
  REQUIRE(fruits.size() == 4 + 4 + 6 + 6);
  CHECK(fruits[8].at("rmse_over_trials_mm") == "2");
  CHECK(fruits[9].at("rmse_over_trials_mm") == "0");
  CHECK(fruits[9].at("centroid_error_mm") == "2");
  const auto localization = read_table(folder / "report/localization.csv");
  CHECK(localization[2].at("rmse_over_trials_worst_mm") == "2");
  CHECK(localization[0].at("centroid_error_mean_mm") == "2.5");
  CHECK(localization[0].at("centroid_error_worst_mm") == "4");
  CHECK(localization[0].at("axis_error_median_deg").empty());
  CHECK(find_row(document, "Lengths in millimetres", "a").at(3) == "0.33 / 2.00");

  const auto curves = read_table(folder / "report/curves.csv");
  REQUIRE(curves.size() == 12);
  CHECK(curves[1].at("view") == "2");
  CHECK(curves[1].at("scanned_observable_pct") == "95");
  CHECK(curves[1].at("recall_observable_pct") == "95");
  const auto scenes = read_table(folder / "report/scenes.csv");
  REQUIRE(scenes.size() == 1);
  CHECK(scenes[0].at("observable_least_fruit_pct") == "62.5");
  CHECK(scenes[0].at("greedy_views_90") == "4");
  CHECK(scenes[0].at("greedy_views_95").empty());
}

TEST_CASE("the truss of the paper's localization table is compared with it, a fruit that is never matched is missing") {
  const TempFolder folder;
  std::vector<study::CellRecord> cells{cell("seven", 7, 1, 1, false), cell("seven", 7, 1, 2, false)};
  report::write_experiment_report(folder / "r.md", cells, {}, kInfo);
  const std::string document = slurp(folder / "r.md");
  const auto first = find_row(document, "## Table 3", "1");
  CHECK(first == std::vector<std::string>{"1", "2 of 2", "0.100 ± 0.010", "0.500 ± 0.020", "0.200 ± 0.030",
                                          "0.060 ± 0.007", "0.519 ± 0.009", "0.154 ± 0.010", "0.00 (3.6)"});
  const auto last = find_row(document, "## Table 3", "7, hidden");
  CHECK(last.at(1) == "0 of 2");
  CHECK(last.at(2) == "-");
  CHECK(last.at(8) == "- (5.6)");
  CHECK(find_row(document, "## Table 3", "**average**").at(8) == "0.00 (4.5)");
  CHECK(document.find("12 of 14 fruit (counted once a scan) were located") != std::string::npos);
  CHECK(find_row(document, "## Table 2", "seven").at(6) == "85.7 (100.0)");
  CHECK(find_row(document, "## Table 2", "seven").at(9) == "-");
  const auto fruits = read_table(folder / "r/fruits.csv");
  CHECK(fruits[6].at("world_x").empty());
  CHECK(fruits[6].at("rmse_over_trials_mm").empty());
  CHECK(fruits[6].at("paper_rmse_mm") == "5.6");
  CHECK(document.find("do not say what can be seen") != std::string::npos);
  CHECK(slurp(folder / "r/scenes.csv").rfind("scene,total,hidden,", 0) == 0);

  for (auto& r : cells) {  // nothing found at all
    for (auto& f : r.fruits) f.found_by.clear();
    for (auto& f : r.metrics.fruits) f = {};
    r.metrics = {};
    r.metrics.fruits.resize(7);
    r.recall_after.clear();
    r.scanned_after.clear();
    r.filtered = r.merged = 0;
    r.seconds.total = std::numeric_limits<double>::quiet_NaN();
  }
  report::write_experiment_report(folder / "r.md", cells, {}, kInfo);
  CHECK(slurp(folder / "r.md").find("None of 14 fruit") != std::string::npos);
  CHECK(slurp(folder / "r.md").find("nan") == std::string::npos);
  CHECK(read_table(folder / "r/scanning.csv")[0].at("seconds").empty());
}

TEST_CASE("the paper's figures are recomputed from its tables and parameters") {
  const TempFolder folder;
  report::write_experiment_report(folder / "r.md", {cell("a", 6, 2, 1)}, {}, kInfo);
  const std::string document = slurp(folder / "r.md");
  const auto row = [&](const std::string& quantity) {  // computed, stated
    const auto cells = find_row(document, "## The paper's figures, recomputed", quantity);
    REQUIRE(cells.size() == 3);
    return cells[1] + ", " + cells[2];
  };
  // The paper's tables, and what its text states.
  CHECK(row("mean recall %") == "72.05, 82.8");
  CHECK(row("mean R_obj %") == "82.7, 82.8");
  CHECK(row("mean mIoU %") == "81.5, 80.7");
  CHECK(row("mean RMSE mm") == "4.5, 4.2");
  CHECK(row("least precision %") == "88.5, 91.6");
  CHECK(row("points kept by SOR, least %") == "59.9, 95.4");
  CHECK(row("points kept by SOR, most %") == "71.3, 95.4");
  CHECK(row("share of a Gaussian below its mean + 2 σ %") == "97.7, 95.4");
  CHECK(row("points of the filtered cloud, 7 fruit, 1 hidden") == "9240, 8325");
  CHECK(row("points left by region growing %") == "68.4, -");
  CHECK(row("points per instance, 7 clusters") == "376, 439");
  CHECK(row("points per instance, 6 clusters") == "439, 439");
  CHECK(row("minimum separation ε mm") == "2.12, -");
  CHECK(row("points within r that make a core point") == "537, -");
  CHECK(row("points within 7 mm on a flat lattice of spacing ε") == "37, 60");
  CHECK(row("fruit of the truss with 5 fruit, 1 hidden") == "5, 6");
  CHECK(row("distance left by the best rigid motion from world to cluster columns mm") == "97, 0");
}

TEST_CASE("the order of the records does not matter") {
  const TempFolder folder;
  std::vector<study::CellRecord> cells;
  std::vector<study::SceneRecord> scenes;
  for (const auto& truss : study::kPaperScanning) {
    const std::string name = "t" + std::to_string(truss.total) + std::to_string(truss.hidden);
    scenes.push_back(scene(name, truss.total, truss.hidden));
    for (const char* preset : {"default", "paper"})
      for (const char* noise : {"none", "gaussian:0.01", "l515", "gaussian:0.002"})
        for (int trial = 1; trial <= 2; ++trial) {
          cells.push_back(cell(name, truss.total, truss.hidden, trial, trial == 1));
          cells.back().cell.preset = preset;
          cells.back().cell.noise = noise;
          cells.back().metrics.recall = 1.0 / (1.0 + static_cast<double>(cells.size()));
        }
  }
  report::write_experiment_report(folder / "one/report.md", cells, scenes, kInfo);
  std::reverse(scenes.begin(), scenes.end());
  Rng rng(5);
  for (std::size_t i = cells.size(); i > 1; --i) std::swap(cells[i - 1], cells[rng.below(i)]);
  report::write_experiment_report(folder / "two/report.md", cells, scenes, kInfo);
  CHECK(slurp(folder / "one/report.md") == slurp(folder / "two/report.md"));
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "one/report")) {
    ++files;
    CHECK(slurp(entry.path()) == slurp(folder / "two/report" / entry.path().filename()));
  }
  CHECK(files == 11);
  // Only one group a preset in full, the others in the summary; noise from mild to harsh.
  const std::string document = slurp(folder / "one/report.md");
  CHECK(document.find("### default / gain / l515") != std::string::npos);
  CHECK(document.find("### paper / gain / gaussian:0.01") != std::string::npos);
  CHECK(document.find("### default / gain / none") == std::string::npos);
  CHECK(document.find("| default / gain / none ") != std::string::npos);
  CHECK(document.find("noise models of the sensor: none, l515, gaussian:0.002, gaussian:0.01\n") != std::string::npos);
  // Every file that is linked is there.
  for (std::size_t at = 0; (at = document.find("](report/", at)) != std::string::npos; ++at) {
    const std::string name = document.substr(at + 2, document.find(')', at) - at - 2);
    CHECK(std::filesystem::exists(folder / "one" / name));
  }
}

TEST_CASE("a report without the paper's tables compares groups, and has only the plots that it shows") {
  const TempFolder folder;
  std::vector<study::CellRecord> cells{cell("a", 6, 2, 1), cell("a", 6, 2, 1)};
  cells[1].cell.planner = "see";
  report::write_experiment_report(folder / "r.md", cells, {scene("a", 6, 2)}, {"1.2.3", "again", false});
  const std::string document = slurp(folder / "r.md");
  CHECK(document.find("## Summary") != std::string::npos);
  CHECK(document.find("## Planners") != std::string::npos);
  CHECK(document.find("## Table") == std::string::npos);
  CHECK(std::filesystem::exists(folder / "r/scanning.csv"));
  CHECK(std::filesystem::exists(folder / "r/planners.svg"));
  CHECK_FALSE(std::filesystem::exists(folder / "r/scanning.svg"));
  CHECK_FALSE(std::filesystem::exists(folder / "r/fruits.csv"));
}

TEST_CASE("names are shown verbatim") {
  const TempFolder folder;
  report::write_experiment_report(folder / "a b.md", {cell("x|y<z>,\"_q_\"", 4, 0, 1)}, {scene("x|y<z>,\"_q_\"", 4, 0)},
                                  {"1", "first\nsecond"});
  const std::string document = slurp(folder / "a b.md");
  CHECK(document.find("x\\|y&lt;z&gt;,\"\\_q\\_\"") != std::string::npos);
  CHECK(document.find("x|y") == std::string::npos);
  CHECK(document.find("<z") == std::string::npos);
  CHECK(document.find("\n    first\n    second\n") != std::string::npos);
  CHECK(document.find("](a%20b/scanning.svg)") != std::string::npos);
  const std::string svg = slurp(folder / "a b/scanning.svg");
  CHECK(svg.find("x|y&lt;z&gt;,&quot;_q_&quot;") != std::string::npos);
  CHECK(slurp(folder / "a b/scanning.csv").find("\n\"x|y<z>,\"\"_q_\"\"\",4,0,") != std::string::npos);
}

TEST_CASE("records of which no report can be written are rejected") {
  const TempFolder folder;
  const auto write = [&](const std::vector<study::CellRecord>& cells,
                         const std::vector<study::SceneRecord>& scenes = {}, const std::string& name = "r.md") {
    report::write_experiment_report(folder / name, cells, scenes, kInfo);
  };
  CHECK_THROWS_WITH(write({}), test::says("there is no record of a scan"));
  CHECK_THROWS_AS(write({}), InputError);
  CHECK_THROWS_WITH(write({cell("a", 3, 0, 1), cell("a", 3, 0, 1)}),
                    test::says("there are two records of the cell a__"));
  CHECK_THROWS_WITH(write({cell("a", 3, 0, 1)}, {scene("a", 3, 0), scene("a", 3, 0)}),
                    test::says("there are two records of the scene"));
  auto uneven = cell("a", 3, 0, 1);
  uneven.fruits.pop_back();
  CHECK_THROWS_WITH(write({uneven}), test::says("different numbers of located and evaluated fruit"));
  CHECK_THROWS_AS(write({cell("a", 3, 0, 1)}, {}, "report"), InputError);
  CHECK(folder.files() == 0);
  folder.file("blocked", "x");
  CHECK_THROWS_AS(write({cell("a", 3, 0, 1)}, {}, "blocked.md"), FileError);
}
