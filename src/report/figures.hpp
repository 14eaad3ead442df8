// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The figures of a report: how each is computed from the record of a scan, and its means over trials and scenes.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "report/groups.hpp"

namespace agrisee::report {

/// Which of two values of a figure is better.
enum class Better { more, less, neither };

/// A figure: how it is computed, shown and judged.
struct Figure {
  const char* title;                                      ///< title of its column, with the unit
  int digits;                                             ///< number of decimals shown
  Better better;                                          ///< which values are better
  std::optional<double> (*of)(const CellRecord&);         ///< value of a scan; none if it has none
  std::optional<double> (*paper)(int total, int hidden);  ///< value in [1] for a truss with these counts; may be null
};

/// The mean of a figure over those scans that have a value.
struct Mean {
  std::optional<double> value;  ///< the mean; none if no scan has a value
  std::size_t have = 0;         ///< number of scans that have a value
  std::size_t of = 0;           ///< number of all scans
};

/// Mean over the trials of a scene.
Mean mean(const Row& row, const Figure& figure);
/// Mean over the means of the scenes.
Mean mean(const Group& group, const Figure& figure);
/// The worst mean of a scene; none if neither direction is better, or if a scan has no value.
std::optional<double> worst_row(const Group& group, const Figure& figure);
/// The worst value of a scan; none if neither direction is better, or if a scan has no value.
std::optional<double> worst_scan(const Group& group, const Figure& figure);
/// Mean of the values in [1] for the scenes of a group; scenes that [1] does not have are left out.
std::optional<double> paper_mean(const Group& group, const Figure& figure);
/// The worst of the values in [1] for the scenes of a group.
std::optional<double> paper_worst(const Group& group, const Figure& figure);

/// Number of views after which `scanned_after` is at least `share`; none if it never is.
std::optional<double> views_to(const CellRecord& cell, double share);
/// Number of views after which every fruit was detected; none if some fruit never was.
std::optional<double> views_to_all(const CellRecord& cell);

/// Mean over the scenes of a group of the share of the observable surface (0..1) that was seen after each view. A scan
/// that has ended keeps its last value.
std::vector<double> scanned_curve(const Group& group);
/// The mean over the scenes of the share of the whole surface (0..1) that was seen after `views` views.
std::optional<double> whole_after(const Group& group, int views);

/// The value if it is finite; otherwise none.
inline std::optional<double> finite(double x) { return std::isfinite(x) ? std::optional(x) : std::nullopt; }
/// The value multiplied by a factor; none if there is no value.
inline std::optional<double> times(double factor, const std::optional<double>& x) {
  return x ? std::optional(factor * *x) : std::nullopt;
}

/// The columns of the tables, shared by the document, the CSV files and the plots.
namespace figure {
extern const Figure views, merged, filtered, seconds, scanned, precision, recall, f1;
extern const Figure precision_all, precision_strict, recall_obs, scanned_obs, observable, views_95, path, path_ratio,
    residual;
extern const Figure plan_ms, belief_seen, belief_observable;
extern const Figure n_real, n_det, counting_error, object_precision, object_recall, miou_surface, miou_point, views_all;
extern const Figure growing_n, growing_recall, growing_miou, clustering_n, clustering_recall, clustering_miou;
}  // namespace figure

}  // namespace agrisee::report
