// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Records of an experiment, sorted into groups and rows, and the figures that a report reads off them.
#pragma once

#include <agrisee/io/report.hpp>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace agrisee::io::report {

using study::CellRecord;
using study::FruitMetrics;
using study::SceneRecord;

/// The trials of one scene within a group.
struct Row {
  std::string scene;
  int total = 0, hidden = 0;
  std::vector<const CellRecord*> trials;  ///< by trial
};

/// All scenes of one preset, planner and noise model.
struct Group {
  std::string preset, planner, noise;
  std::vector<Row> rows;  ///< by fruit, hidden fruit and name

  std::string name() const { return preset + " / " + planner + " / " + noise; }
  std::size_t scans() const;
};

/// Everything that a report is about. The pointers are to the caller's records.
struct Data {
  std::vector<Group> groups;               ///< by preset, planner and noise
  std::vector<const SceneRecord*> scenes;  ///< by fruit, hidden fruit and name
  std::string folder;                      ///< what links to the files beside the document begin with, fit for a URL
};

/// Sort records. @throws InputError as write_report()
Data arrange(const std::vector<CellRecord>& cells, const std::vector<SceneRecord>& scenes);

/// The groups that a report shows in full, one a preset: default with l515 and paper with gaussian:0.01, each with its
/// own planner; the preset's first group where there is none.
std::vector<const Group*> main_groups(const Data& data);
/// The groups of the presets' own planners (default: gain, paper: see; else the first), one a preset and noise.
std::vector<const Group*> own_planner_groups(const Data& data);
/// The different values of a text, in the order of the groups.
std::vector<std::string> distinct(const Data& data, std::string Group::*text);
/// Names of noise models, mildest first as far as they are known.
std::vector<std::string> noises(const Data& data);

/// Which of two values is the better one.
enum class Better { more, less, neither };

/// A figure of a cell: how it is read off, shown and judged.
struct Figure {
  const char* title;  ///< head of its column, with unit
  int digits;         ///< decimals shown
  Better better;
  std::optional<double> (*of)(const CellRecord&);         ///< ours
  std::optional<double> (*paper)(int total, int hidden);  ///< the paper's; null where it has none
};

/// A mean over what has a value.
struct Mean {
  std::optional<double> value;
  std::size_t have = 0;  ///< scans that have a value
  std::size_t of = 0;    ///< of so many
};

/// Mean over the trials of a scene.
Mean mean(const Row& row, const Figure& figure);
/// Mean over the scenes' means.
Mean mean(const Group& group, const Figure& figure);
/// The worst of the scenes' means; none where no direction is better, or some scan has no value.
std::optional<double> worst_row(const Group& group, const Figure& figure);
/// The worst single scan; none as above.
std::optional<double> worst_scan(const Group& group, const Figure& figure);
/// Mean of the paper's values over the scenes of a group that it has.
std::optional<double> paper_mean(const Group& group, const Figure& figure);
/// The worst of them.
std::optional<double> paper_worst(const Group& group, const Figure& figure);

/// Statistics of the magnitudes of an error.
struct Errors {
  std::optional<double> mean, median, worst;
  std::size_t count = 0;  ///< values
};
/// Of any values; those that are not finite are left out.
Errors statistics(std::vector<double> values);
/// Of all fruit of all scans of a scene, or of a group's scenes.
Errors errors(const Row& row, std::optional<double> FruitMetrics::*error);
Errors errors(const Group& group, std::optional<double> FruitMetrics::*error);

/// One fruit over the trials of a scene.
struct FruitTrials {
  int id = 0;
  bool hidden = false;
  std::size_t trials = 0;                                                     ///< scans of it
  std::vector<Eigen::Vector3d> world, cluster, sigma;                         ///< one a scan that located it
  std::optional<double> rmse() const { return study::repeatability(world); }  ///< m
};
std::vector<FruitTrials> fruit_trials(const Row& row);
/// Repeatability (m) over the fruit of a scene that two trials or more located, or of a group's scenes.
Errors repeatability(const Row& row);
Errors repeatability(const Group& group);
/// Fruit times scans, and how many of them were located.
struct Located {
  std::size_t found = 0, all = 0;
  std::size_t missing() const { return all - found; }
};
Located located(const Row& row);
Located located(const Group& group);
/// The least share of its observable surface that any fruit got (0..1).
std::optional<double> least_recall(const Row& row);
std::optional<double> least_recall(const Group& group);

/// Views after which `recall_after` is at least `share`; none if never.
std::optional<double> views_to(const CellRecord& cell, double share);
/// Views after which every fruit was a true detection; none if never.
std::optional<double> views_to_all(const CellRecord& cell);

/// A value that is finite, or none.
inline std::optional<double> finite(double x) { return std::isfinite(x) ? std::optional(x) : std::nullopt; }

/// Columns of the tables, shared by document, CSV and plots.
namespace figure {
extern const Figure views, merged, filtered, seconds, scanned, precision, recall, f1;
extern const Figure precision_all, precision_strict, recall_obs, observable, views_95, path, path_ratio, residual;
extern const Figure belief_seen, belief_observable;
extern const Figure n_real, n_det, counting_error, object_precision, object_recall, miou_surface, miou_point, views_all;
extern const Figure growing_n, growing_recall, growing_miou, clustering_n, clustering_recall, clustering_miou;
}  // namespace figure

/// A number with so many decimals, whatever the locale; `-` for none.
std::string fixed(const std::optional<double>& value, int digits);
/// A name as Markdown shows it verbatim, also inside a table.
std::string text(const std::string& name);

/// A mean as text: `-` for none, with [have/of] where not all scans have a value, and the paper's value in parentheses.
std::string shown(const Mean& mean, int digits, const std::optional<double>& paper = std::nullopt);
/// `mean / worst`.
std::string pair(const std::optional<double>& mean, const std::optional<double>& worst, int digits);
/// Why scans stopped, with counts where reasons differ.
std::string stop_reasons(const Row& row);
std::string stop_reasons(const Group& group);
/// An embedded picture, a paragraph of its own.
std::string picture(const Data& data, const std::string& file, const std::string& says);

/// A Markdown table; the first column is aligned to the left, the others to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> head) : head_(std::move(head)) {}
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string markdown() const;

 private:
  std::vector<std::string> head_;
  std::vector<std::vector<std::string>> rows_;
};

/// A file beside the document.
struct File {
  std::string name;
  std::string bytes;
};
/// All CSV tables.
std::vector<File> csv_files(const Data& data);
/// All plots that the records suffice for.
std::vector<File> plots(const Data& data);

/// Sections of the document, each ending in a line break.
std::string introduction(const Data& data, const ReportInfo& info);
std::string summary_section(const Data& data);
std::string scanning_section(const Data& data);
std::string segmentation_section(const Data& data);
std::string localization_section(const Data& data);
std::string noise_section(const Data& data);
std::string planner_section(const Data& data);
std::string limit_section(const Data& data);
std::string contradictions_section(const Data& data);

/// Mean over a group's scenes of the share of the observable surface (0..1) after each view; a scan that has ended
/// keeps what it had.
std::vector<double> recall_curve(const Group& group);

/// The noise model under which most pairs of preset and planner were run.
std::string comparison_noise(const Data& data);

}  // namespace agrisee::io::report
