// SPDX-License-Identifier: BSD-3-Clause
// The figures of a report, and its Markdown tables.
#include <agrisee/study/paper_tables.hpp>

#include <algorithm>

#include "report_data.hpp"

namespace agrisee::io::report {
namespace figure {
namespace {

using study::PaperScanning;
using study::PaperSegmentation;
using Value = std::optional<double>;
using C = const CellRecord&;

template <auto Member>
Value scanning(int total, int hidden) {
  const PaperScanning* row = study::paper_scanning(total, hidden);
  return row ? Value(static_cast<double>(row->*Member)) : std::nullopt;
}
template <auto Member>
Value segmentation(int total, int hidden) {
  const PaperSegmentation* row = study::paper_segmentation(total, hidden);
  return row ? Value(static_cast<double>(row->*Member)) : std::nullopt;
}
/// A share of the metrics as a percentage, or a count as it is.
template <auto Member>
Value percent(C c) {
  return 100.0 * (c.metrics.*Member);
}
template <auto Member>
Value count(C c) {
  return static_cast<double>(c.metrics.*Member);
}
template <auto Stage, auto Member>
Value stage(C c) {
  return static_cast<double>((c.*Stage).*Member);
}
template <auto Stage, auto Member>
Value stage_percent(C c) {
  return 100.0 * ((c.*Stage).*Member);
}
/// The paper's text tells the residual of one truss.
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

std::string fixed(const std::optional<double>& value, int digits) {
  if (!value || !std::isfinite(*value) || std::abs(*value) > 1e15) return "-";
  long long unit = 1;
  for (int i = 0; i < digits; ++i) unit *= 10;
  const long long n = std::llround(std::abs(*value) * static_cast<double>(unit));
  std::string digits_text = std::to_string(n % unit);
  std::string out = *value < 0.0 && n > 0 ? "-" : "";
  out += std::to_string(n / unit);
  if (digits == 0) return out;
  digits_text.insert(0, static_cast<std::size_t>(digits) - digits_text.size(), '0');
  return out + "." + digits_text;
}

std::string text(const std::string& name) {
  const auto is_word = [&](std::size_t i) {
    if (i >= name.size()) return false;
    const auto c = static_cast<unsigned char>(name[i]);
    return (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z');
  };
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '|':
      case '\\':
      case '`':
      case '*':
      case '[':
      case ']':
      case '#':
      case '~':
      case '$':
        out += '\\', out += c;
        break;
      case '_':
        if (i == 0 || !is_word(i - 1) || !is_word(i + 1)) out += '\\';
        out += c;
        break;
      default:
        out += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
  }
  return out;
}

std::string shown(const Mean& mean, int digits, const std::optional<double>& paper) {
  std::string out = fixed(mean.value, digits);
  if (mean.value && mean.have < mean.of) out += " [" + std::to_string(mean.have) + "/" + std::to_string(mean.of) + "]";
  if (paper) out += " (" + fixed(paper, digits) + ")";
  return out;
}

std::string pair(const std::optional<double>& mean, const std::optional<double>& worst, int digits) {
  if (!mean && !worst) return "-";
  return fixed(mean, digits) + " / " + fixed(worst, digits);
}

std::string Table::markdown() const {
  const auto width = [](const std::string& s) {  // characters of UTF-8
    std::size_t n = 0;
    for (const char c : s) n += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    return n;
  };
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < head_.size(); ++i) {
    std::size_t widest = std::max<std::size_t>(3, width(head_[i]));
    for (const auto& row : rows_) widest = std::max(widest, width(row.at(i)));
    widths.push_back(widest);
  }
  std::string out;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const std::string pad(widths[i] - width(cells[i]), ' ');
      out += "| " + (i == 0 ? cells[i] + pad : pad + cells[i]) + ' ';
    }
    out += "|\n";
  };
  line(head_);
  for (std::size_t i = 0; i < widths.size(); ++i)
    out += "| " + (i == 0 ? std::string(widths[i], '-') : std::string(widths[i] - 1, '-') + ":") + ' ';
  out += "|\n";
  for (const auto& row : rows_) line(row);
  return out;
}

}  // namespace agrisee::io::report
