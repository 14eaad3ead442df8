// SPDX-License-Identifier: BSD-3-Clause
#include "report/figures.hpp"

#include <agrisee/study/paper_tables.hpp>

#include <algorithm>

#include "report/errors.hpp"

namespace agrisee::report {
namespace {

bool is_worse(double a, double b, Better better) { return better == Better::more ? a < b : a > b; }

/// The worst of these values; none if neither direction is better, or if one of them is missing.
std::optional<double> worst_of(const std::vector<std::optional<double>>& values, Better better) {
  if (better == Better::neither) return std::nullopt;
  std::optional<double> worst;
  for (const std::optional<double>& value : values) {
    if (!value) return std::nullopt;
    if (!worst || is_worse(*value, *worst, better)) worst = value;
  }
  return worst;
}

/// The values in [1] for those scenes of a group that it has.
std::vector<double> paper_values(const Group& group, const Figure& figure) {
  std::vector<double> values;
  if (figure.paper)
    for (const Row& row : group.rows)
      if (const auto value = figure.paper(row.total, row.hidden)) values.push_back(*value);
  return values;
}

/// Mean over the scenes, and their trials, of a share after view `i` (from 0). A scan that has ended keeps its last.
std::optional<double> mean_after(const Group& group, std::vector<double> CellRecord::*shares, std::size_t i) {
  double sum = 0.0;
  for (const Row& row : group.rows)
    for (const CellRecord* cell : row.trials) {
      const std::vector<double>& after = cell->*shares;
      if (after.empty()) return std::nullopt;
      sum += after[std::min(i, after.size() - 1)] / static_cast<double>(row.trials.size());
    }
  return group.rows.empty() ? std::nullopt : std::optional(sum / static_cast<double>(group.rows.size()));
}

}  // namespace

Mean mean(const Row& row, const Figure& figure) {
  Mean m;
  double sum = 0.0;
  for (const CellRecord* cell : row.trials) {
    ++m.of;
    const std::optional<double> value = figure.of(*cell);
    if (!value || !std::isfinite(*value)) continue;
    ++m.have;
    sum += *value;
  }
  if (m.have > 0) m.value = sum / static_cast<double>(m.have);
  return m;
}

Mean mean(const Group& group, const Figure& figure) {
  Mean m;
  double sum = 0.0;
  int rows = 0;
  for (const Row& row : group.rows) {
    const Mean of_row = mean(row, figure);
    m.have += of_row.have;
    m.of += of_row.of;
    if (!of_row.value) continue;
    sum += *of_row.value;
    ++rows;
  }
  if (rows > 0) m.value = sum / rows;
  return m;
}

std::optional<double> worst_row(const Group& group, const Figure& figure) {
  std::vector<std::optional<double>> values;
  for (const Row& row : group.rows) {
    const Mean m = mean(row, figure);
    values.push_back(m.have == m.of ? m.value : std::nullopt);
  }
  return worst_of(values, figure.better);
}

std::optional<double> worst_scan(const Group& group, const Figure& figure) {
  std::vector<std::optional<double>> values;
  for (const Row& row : group.rows)
    for (const CellRecord* cell : row.trials) {
      const std::optional<double> value = figure.of(*cell);
      values.push_back(value ? finite(*value) : std::nullopt);
    }
  return worst_of(values, figure.better);
}

std::optional<double> paper_mean(const Group& group, const Figure& figure) {
  return statistics(paper_values(group, figure)).mean;
}

std::optional<double> paper_worst(const Group& group, const Figure& figure) {
  std::vector<std::optional<double>> values;
  for (const double value : paper_values(group, figure)) values.emplace_back(value);
  return worst_of(values, figure.better);
}

std::optional<double> views_to(const CellRecord& cell, double share) {
  for (std::size_t i = 0; i < cell.scanned_after.size(); ++i)
    if (cell.scanned_after[i] >= share) return static_cast<double>(i + 1);
  return std::nullopt;
}

std::optional<double> views_to_all(const CellRecord& cell) {
  for (std::size_t i = 0; i < cell.true_after.size(); ++i)
    if (cell.true_after[i] >= cell.metrics.n_real) return static_cast<double>(i + 1);
  return std::nullopt;
}

std::vector<double> scanned_curve(const Group& group) {
  std::size_t length = 0;
  for (const Row& row : group.rows)
    for (const CellRecord* cell : row.trials) length = std::max(length, cell->scanned_after.size());
  std::vector<double> curve;
  for (std::size_t i = 0; i < length; ++i)
    curve.push_back(mean_after(group, &CellRecord::scanned_after, i).value_or(0.0));
  return curve;
}

std::optional<double> whole_after(const Group& group, int views) {
  return mean_after(group, &CellRecord::whole_after, static_cast<std::size_t>(std::max(views, 1) - 1));
}

namespace figure {
namespace {

using study::PaperScanning;
using study::PaperSegmentation;
using Value = std::optional<double>;
using C = const CellRecord&;

/// A column of the scanning table of [1].
template <auto Member>
Value scanning(int total, int hidden) {
  const PaperScanning* row = study::paper_scanning(total, hidden);
  return row ? Value(static_cast<double>(row->*Member)) : std::nullopt;
}
/// A column of the segmentation table of [1].
template <auto Member>
Value segmentation(int total, int hidden) {
  const PaperSegmentation* row = study::paper_segmentation(total, hidden);
  return row ? Value(static_cast<double>(row->*Member)) : std::nullopt;
}
/// A share of the metrics, in percent.
template <auto Member>
Value percent(C c) {
  return 100.0 * (c.metrics.*Member);
}
/// A count of the metrics.
template <auto Member>
Value count(C c) {
  return static_cast<double>(c.metrics.*Member);
}
/// A count of one of the two stages alone.
template <auto Stage, auto Member>
Value stage(C c) {
  return static_cast<double>((c.*Stage).*Member);
}
/// A share of one of the two stages alone, in percent.
template <auto Stage, auto Member>
Value stage_percent(C c) {
  return 100.0 * ((c.*Stage).*Member);
}
/// The text of [1] states the residual of one truss.
Value paper_residual(int total, int hidden) {
  if (total != study::kPaperLocalizationTotal || hidden != study::kPaperLocalizationHidden) return std::nullopt;
  const study::PaperText& t = study::kPaperText;
  return 100.0 * (t.residual_cloud - t.residual_grown) / t.residual_cloud;
}

using M = study::Metrics;
using A = study::StageAlone;
constexpr Better kMore = Better::more, kLess = Better::less, kNeither = Better::neither;

}  // namespace

const Figure views{"views", 1, kLess, [](C c) -> Value { return c.views; }, scanning<&PaperScanning::views>};
const Figure merged{"points merged", 0, kNeither, [](C c) -> Value { return static_cast<double>(c.merged); },
                    scanning<&PaperScanning::merged>};
const Figure filtered{"after SOR", 0, kNeither, [](C c) -> Value { return static_cast<double>(c.filtered); },
                      scanning<&PaperScanning::filtered>};
const Figure seconds{"computing s", 1, kLess, [](C c) { return finite(c.seconds.total); },
                     scanning<&PaperScanning::seconds>};
const Figure scanned{"scanned %", 1, kMore, percent<&M::scanned>, scanning<&PaperScanning::scanned>};
const Figure precision{"precision %", 1, kMore, percent<&M::precision>, scanning<&PaperScanning::precision>};
const Figure recall{"recall %", 1, kMore, percent<&M::recall>, scanning<&PaperScanning::recall>};
const Figure f1{"F1 %", 1, kMore, percent<&M::f1>, scanning<&PaperScanning::f1>};

const Figure precision_all{"precision, all points %", 1, kMore, percent<&M::precision_all>, nullptr};
const Figure precision_strict{"precision at 2 mm %", 1, kMore, percent<&M::precision_strict>, nullptr};
const Figure recall_obs{"recall, observable %", 1, kMore, percent<&M::recall_obs>, nullptr};
const Figure scanned_obs{"scanned, observable %", 1, kMore, percent<&M::scanned_obs>, nullptr};
const Figure observable{"observable %", 1, kMore, percent<&M::observable>, nullptr};
const Figure views_95{"views to 95 %", 1, kLess, [](C c) { return views_to(c, 0.95); }, nullptr};
const Figure path{"path rad", 1, kLess, [](C c) { return finite(c.path); }, nullptr};
const Figure path_ratio{
    "path / shortest", 2, kLess,
    [](C c) -> Value { return c.shortest_path > 0.0 ? finite(c.path / c.shortest_path) : std::nullopt; }, nullptr};
const Figure residual{"residual %", 1, kNeither,
                      [](C c) -> Value {
                        if (c.filtered == 0) return std::nullopt;
                        return 100.0 * static_cast<double>(c.residual) / static_cast<double>(c.filtered);
                      },
                      paper_residual};

const Figure plan_ms{"planning ms a view", 1, kLess,
                     [](C c) -> Value {
                       if (c.views == 0) return std::nullopt;
                       return finite(1e3 * c.seconds.plan / c.views);
                     },
                     nullptr};
const Figure belief_seen{"believed - scanned, points", 1, kNeither,
                         [](C c) -> Value {
                           if (c.believed_observable <= 0.0) return std::nullopt;
                           return 100.0 * (c.believed_seen - c.metrics.scanned);
                         },
                         nullptr};
const Figure belief_observable{"believed - observable, points", 1, kNeither,
                               [](C c) -> Value {
                                 if (c.believed_observable <= 0.0) return std::nullopt;
                                 return 100.0 * (c.believed_observable - c.metrics.observable);
                               },
                               nullptr};

const Figure n_real{"N_real", 0, kNeither, count<&M::n_real>, segmentation<&PaperSegmentation::n_real>};
const Figure n_det{"N_det", 1, kNeither, count<&M::n_det>, segmentation<&PaperSegmentation::n_det>};
const Figure counting_error{"CE", 1, kLess, count<&M::counting_error>,
                            segmentation<&PaperSegmentation::counting_error>};
const Figure object_precision{"P_obj %", 1, kMore, percent<&M::object_precision>,
                              segmentation<&PaperSegmentation::object_precision>};
const Figure object_recall{"R_obj %", 1, kMore, percent<&M::object_recall>,
                           segmentation<&PaperSegmentation::object_recall>};
const Figure miou_surface{"mIoU %, surface", 1, kMore, percent<&M::miou_surface>,
                          segmentation<&PaperSegmentation::miou>};
const Figure miou_point{"mIoU %, points", 1, kMore, percent<&M::miou_point>, nullptr};
const Figure views_all{"views to all fruit", 1, kLess, [](C c) { return views_to_all(c); }, nullptr};

const Figure growing_n{"region growing N_det", 1, kNeither, stage<&CellRecord::growing, &A::n_det>, nullptr};
const Figure growing_recall{"R_obj %", 1, kMore, stage_percent<&CellRecord::growing, &A::object_recall>, nullptr};
const Figure growing_miou{"mIoU %", 1, kMore, stage_percent<&CellRecord::growing, &A::miou>, nullptr};
const Figure clustering_n{"DBSCAN N_det", 1, kNeither, stage<&CellRecord::clustering, &A::n_det>, nullptr};
const Figure clustering_recall{"R_obj %", 1, kMore, stage_percent<&CellRecord::clustering, &A::object_recall>, nullptr};
const Figure clustering_miou{"mIoU %", 1, kMore, stage_percent<&CellRecord::clustering, &A::miou>, nullptr};

}  // namespace figure

}  // namespace agrisee::report
