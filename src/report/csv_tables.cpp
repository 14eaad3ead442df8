// SPDX-License-Identifier: BSD-3-Clause
// The CSV files of a report, with a row per cell, fruit, view or scene. They hold single values, not averages.
#include <agrisee/study/paper_tables.hpp>

#include <algorithm>

#include "io/formats/csv.hpp"
#include "report/errors.hpp"
#include "report/figures.hpp"
#include "report/markdown.hpp"
#include "report/sections.hpp"

namespace agrisee::report {
namespace {

using Value = std::optional<double>;

/// Writes a table cell by cell, with the name of the column. The names in the first row become the head.
class Columns {
 public:
  void operator()(const char* name, const std::string& text) {
    if (!headed_) head_.cell(name);
    body_.cell(text);
  }
  /// A number rounded to `digits` decimals, without trailing zeros; an empty cell if there is none.
  void operator()(const char* name, const Value& value, int digits) {
    std::string text = fixed(value, digits);
    if (text == "-") text.clear();
    if (text.find('.') != std::string::npos) {
      text.erase(text.find_last_not_of('0') + 1);
      if (text.back() == '.') text.pop_back();
    }
    (*this)(name, text);
  }
  void percent(const char* name, const Value& share) { (*this)(name, share ? Value(100.0 * *share) : share, 4); }
  void number(const char* name, double value) { (*this)(name, Value(value), 0); }
  void end_row() {
    if (!headed_) head_.end_row();
    headed_ = true;
    body_.end_row();
  }
  std::string head() const { return head_.text(); }
  std::string text() const { return head_.text() + body_.text(); }

 private:
  io::CsvWriter head_, body_;
  bool headed_ = false;
};

/// The columns that tell which scan a row is about.
void cell_columns(Columns& c, const CellRecord& r) {
  c("scene", r.cell.scene);
  c.number("total", r.total);
  c.number("hidden", r.hidden);
  c("preset", r.cell.preset);
  c("planner", r.cell.planner);
  c("noise", r.cell.noise);
  c("reach", r.cell.reach);
  c.number("trial", r.cell.trial);
}

/// A table to which write_cell(columns, cell, row) adds the rows of every cell.
template <typename F>
std::string table(const Data& data, F&& write_cell) {
  Columns c;
  for (const Group& group : data.groups)
    for (const Row& row : group.rows)
      for (const CellRecord* cell : row.trials) write_cell(c, *cell, row);
  return c.text();
}

/// A member of a row of [1]; none if there is no row.
template <typename Row, typename T>
Value of(const Row* row, T Row::*member) {
  return row ? Value(static_cast<double>(row->*member)) : std::nullopt;
}

std::string scanning(const Data& data) {
  return table(data, [](Columns& c, const CellRecord& r, const Row&) {
    cell_columns(c, r);
    const study::Metrics& m = r.metrics;
    c.number("views", r.views);
    c.number("points_merged", static_cast<double>(r.merged));
    c.number("points_post_sor", static_cast<double>(r.filtered));
    c("seconds", r.seconds.total, 4);
    c.percent("scanned_pct", m.scanned);
    c.percent("precision_pct", m.precision);
    c.percent("recall_pct", m.recall);
    c.percent("f1_pct", m.f1);
    c.percent("observable_pct", m.observable);
    c.percent("recall_observable_pct", m.recall_obs);
    c.percent("scanned_observable_pct", m.scanned_obs);
    c.percent("precision_2mm_pct", m.precision_strict);
    c.percent("precision_all_points_pct", m.precision_all);
    c.percent("precision_all_points_2mm_pct", m.precision_all_strict);
    c("views_to_95pct", views_to(r, 0.95), 0);
    c.percent("believed_scanned_pct", r.believed_seen);
    c.percent("believed_observable_pct", r.believed_observable);
    c("path_rad", r.path, 4);
    c("shortest_path_rad", r.shortest_path, 4);
    c("path_ratio", figure::path_ratio.of(r), 4);
    c("residual_pct", figure::residual.of(r), 4);
    c("stop_reason", r.stop_reason);
    c("seconds_capture", r.seconds.capture, 4);
    c("seconds_plan", r.seconds.plan, 4);
    c("seconds_fuse", r.seconds.fuse, 4);
    c("seconds_filter", r.seconds.filter, 4);
    c("seconds_normals", r.seconds.normals, 4);
    c("seconds_segment", r.seconds.segment, 4);
    c("seconds_locate", r.seconds.locate, 4);
    using P = study::PaperScanning;
    const P* paper = study::paper_scanning(r.total, r.hidden);
    c("paper_views", of(paper, &P::views), 0);
    c("paper_points_merged", of(paper, &P::merged), 0);
    c("paper_points_post_sor", of(paper, &P::filtered), 0);
    c("paper_seconds", of(paper, &P::seconds), 1);
    c("paper_scanned_pct", of(paper, &P::scanned), 1);
    c("paper_precision_pct", of(paper, &P::precision), 1);
    c("paper_recall_pct", of(paper, &P::recall), 1);
    c("paper_f1_pct", of(paper, &P::f1), 1);
    c.end_row();
  });
}

std::string segmentation(const Data& data) {
  return table(data, [](Columns& c, const CellRecord& r, const Row&) {
    cell_columns(c, r);
    const study::Metrics& m = r.metrics;
    c.number("n_real", m.n_real);
    c.number("n_detected", m.n_det);
    c.number("n_true", m.n_true);
    c.number("counting_error", m.counting_error);
    c.percent("p_obj_pct", m.object_precision);
    c.percent("r_obj_pct", m.object_recall);
    c.percent("miou_pct", m.miou_surface);
    c.percent("miou_points_pct", m.miou_point);
    c("views_to_all_fruit", views_to_all(r), 0);
    c.number("growing_n_detected", r.growing.n_det);
    c.percent("growing_p_obj_pct", r.growing.object_precision);
    c.percent("growing_r_obj_pct", r.growing.object_recall);
    c.percent("growing_miou_pct", r.growing.miou);
    c.number("dbscan_n_detected", r.clustering.n_det);
    c.percent("dbscan_p_obj_pct", r.clustering.object_precision);
    c.percent("dbscan_r_obj_pct", r.clustering.object_recall);
    c.percent("dbscan_miou_pct", r.clustering.miou);
    using P = study::PaperSegmentation;
    const P* paper = study::paper_segmentation(r.total, r.hidden);
    c("paper_n_real", of(paper, &P::n_real), 0);
    c("paper_n_detected", of(paper, &P::n_det), 0);
    c("paper_counting_error", of(paper, &P::counting_error), 0);
    c("paper_p_obj_pct", of(paper, &P::object_precision), 1);
    c("paper_r_obj_pct", of(paper, &P::object_recall), 1);
    c("paper_miou_pct", of(paper, &P::miou), 1);
    c.end_row();
  });
}

/// The errors of the fruit of each scan, and the repeatability over all trials of its scene.
std::string localization(const Data& data) {
  return table(data, [](Columns& c, const CellRecord& r, const Row& row) {
    cell_columns(c, r);
    const Row alone{row.scene, row.total, row.hidden, {&r}};
    const Located l = located(alone);
    c.number("fruit", static_cast<double>(l.all));
    c.number("located", static_cast<double>(l.found));
    const Errors rmse = repeatability(row);
    c("rmse_over_trials_mean_mm", times(1e3, rmse.mean), 4);
    c("rmse_over_trials_worst_mm", times(1e3, rmse.worst), 4);
    const auto both = [&](std::optional<double> FruitMetrics::*error, const char* mean, const char* worst,
                          double factor) {
      const Errors e = errors(alone, error);
      c(mean, times(factor, e.mean), 4);
      c(worst, times(factor, e.worst), 4);
    };
    both(&FruitMetrics::centroid_error, "centroid_error_mean_mm", "centroid_error_worst_mm", 1e3);
    both(&FruitMetrics::centroid_error_seen, "centroid_error_seen_mean_mm", "centroid_error_seen_worst_mm", 1e3);
    both(&FruitMetrics::center_error, "center_error_mean_mm", "center_error_worst_mm", 1e3);
    both(&FruitMetrics::radius_error, "radius_error_mean_mm", "radius_error_worst_mm", 1e3);
    both(&FruitMetrics::semi_axis_error, "semi_axis_error_mean_mm", "semi_axis_error_worst_mm", 1e3);
    const Errors axis = errors(alone, &FruitMetrics::axis_error);
    c("axis_error_median_deg", times(180.0 / kPi, axis.median), 4);
    c("axis_error_worst_deg", times(180.0 / kPi, axis.worst), 4);
    both(&FruitMetrics::completeness_error, "completeness_error_mean_pct", "completeness_error_worst_pct", 100.0);
    c.percent("least_recall_observable_pct", least_recall(alone));
    c.end_row();
  });
}

std::string fruits(const Data& data) {
  return table(data, [](Columns& c, const CellRecord& r, const Row& row) {
    const std::vector<FruitTrials> trials = fruit_trials(row);
    for (std::size_t i = 0; i < r.fruits.size(); ++i) {
      const study::LocatedFruit& fruit = r.fruits[i];
      const FruitMetrics& m = r.metrics.fruits[i];
      const bool found = !fruit.found_by.empty();
      cell_columns(c, r);
      c.number("fruit", fruit.id);
      c.number("fruit_hidden", fruit.hidden);
      c("found_by", fruit.found_by);
      c.number("detected", m.detected);
      const auto point = [&](const Eigen::Vector3d& p, const char* x, const char* y, const char* z) {
        c(x, found ? Value(p.x()) : std::nullopt, 6);
        c(y, found ? Value(p.y()) : std::nullopt, 6);
        c(z, found ? Value(p.z()) : std::nullopt, 6);
      };
      point(fruit.centroid, "world_x", "world_y", "world_z");
      point(fruit.centroid_cluster, "cluster_x", "cluster_y", "cluster_z");
      point(fruit.sigma, "sigma_x", "sigma_y", "sigma_z");
      Value rmse;
      for (const FruitTrials& t : trials)
        if (t.id == fruit.id) rmse = t.rmse();
      c("rmse_over_trials_mm", times(1e3, rmse), 4);
      const study::PaperLocalization* paper = study::paper_localization(row.total, row.hidden, fruit.id);
      c("paper_rmse_mm", of(paper, &study::PaperLocalization::rmse), 1);
      c.percent("surface_iou_pct", m.surface_iou);
      c.percent("point_iou_pct", m.point_iou);
      c.percent("recall_pct", m.recall);
      c.percent("recall_observable_pct", m.recall_obs);
      c.percent("scanned_pct", m.scanned);
      c.percent("observable_pct", m.observable);
      const auto error = [&](const char* name, const Value& x, double factor) { c(name, times(factor, x), 4); };
      error("centroid_error_mm", m.centroid_error, 1e3);
      error("centroid_error_seen_mm", m.centroid_error_seen, 1e3);
      error("center_error_mm", m.center_error, 1e3);
      error("radius_error_mm", m.radius_error, 1e3);
      error("semi_axis_error_mm", m.semi_axis_error, 1e3);
      error("axis_error_deg", m.axis_error, 180.0 / kPi);
      error("completeness_error_pct", m.completeness_error, 100.0);
      c.end_row();
    }
  });
}

std::string curves(const Data& data) {
  return table(data, [](Columns& c, const CellRecord& r, const Row&) {
    const std::size_t views =
        std::max({r.whole_after.size(), r.scanned_after.size(), r.recall_after.size(), r.true_after.size()});
    const auto share = [](const std::vector<double>& after, std::size_t i) {
      return i < after.size() ? Value(after[i]) : std::nullopt;
    };
    for (std::size_t i = 0; i < views; ++i) {
      cell_columns(c, r);
      c.number("view", static_cast<double>(i + 1));
      c.percent("scanned_pct", share(r.whole_after, i));
      c.percent("scanned_observable_pct", share(r.scanned_after, i));
      c.percent("recall_observable_pct", share(r.recall_after, i));
      c("true_detections", i < r.true_after.size() ? Value(r.true_after[i]) : std::nullopt, 0);
      c.end_row();
    }
  });
}

std::string scene_table(const Data& data) {
  Columns c;
  const auto write = [&](const SceneRecord* s) {
    c("scene", s->scene);
    c.number("total", s->total);
    c.number("hidden", s->hidden);
    c.percent("observable_pct", s->observable);
    c.percent("observable_least_fruit_pct", s->observable_least);
    c.percent("hidden_fruit_from_in_front_most_pct", s->hidden > 0 ? Value(s->hidden_share_most) : std::nullopt);
    const auto views = [&](const char* name, int n) { c(name, n > 0 ? Value(n) : std::nullopt, 0); };
    views("greedy_views_90", s->views_90);
    views("greedy_views_95", s->views_95);
    views("greedy_views_98", s->views_98);
    views("greedy_views_99", s->views_99);
    c.end_row();
  };
  for (const SceneRecord* scene : data.scenes) write(scene);
  if (!data.scenes.empty()) return c.text();
  const SceneRecord none;
  write(&none);
  return c.head();
}

}  // namespace

std::vector<File> csv_files(const Data& data) {
  return {{"scanning.csv", scanning(data)},
          {"segmentation.csv", segmentation(data)},
          {"localization.csv", localization(data)},
          {"fruits.csv", fruits(data)},
          {"curves.csv", curves(data)},
          {"scenes.csv", scene_table(data)}};
}

}  // namespace agrisee::report
