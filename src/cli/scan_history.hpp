// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the page of a simulated scan shows of its course.
#pragma once

#include <agrisee/io/scan_page.hpp>
#include <agrisee/pipeline.hpp>
#include <agrisee/see/density.hpp>
#include <agrisee/study/evaluate.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace agrisee::cli {

/// Collects what the page of a scan shows of its course: the depth images, the planner's estimates, what was really
/// seen, and the frontier of SEE++.
class HistoryRecorder {
 public:
  HistoryRecorder(const study::Scene& scene, const Parameters& parameters, int threads)
      : parameters_(parameters), threads_(threads) {
    try {
      samples_ = study::fruit_samples(scene);
    } catch (const InputError&) {  // fruit without a surface: what was really seen of it is not shown
    }
  }
  /// Call with the frame of every view.
  void take(std::size_t view, const sensor::DepthFrame& frame) {
    depth_.resize(view + 1);
    depth_[view] = io::depth_picture(frame);
  }
  /// Call after every view. The planner's estimates are those from before the view.
  void observe(const Pipeline& pipeline, const Cloud& raw) {
    if (!scanned_.empty()) add_estimate(pipeline.completeness(), seen_, observable_);
    const double threshold = study::MetricParameters().threshold;
    const study::Flags covered = study::cover(samples_, raw.points, threshold, threads_).covered;
    scanned_.push_back(static_cast<double>(std::count(covered.begin(), covered.end(), 1)) /
                       static_cast<double>(std::max<std::size_t>(covered.size(), 1)));
    merged_ = pipeline.merged();
  }
  /// The history of the scan that has come to this result.
  io::ScanHistory history(const ScanResult& result) const {
    io::ScanHistory history;
    history.depth = depth_;
    std::vector<double> seen = seen_, observable = observable_;
    // After the last view the planner made an estimate only if it was asked for one more, and had the right to it.
    const bool asked = result.stop_reason != StopReason::max_views && result.stop_reason != StopReason::not_stopped;
    if (!scanned_.empty()) add_estimate(asked ? result.completeness : std::nullopt, seen, observable);
    const auto known = [](double value) { return std::isfinite(value); };
    if (std::any_of(seen.begin(), seen.end(), known))
      history.curves = {{"seen, as the planner believes", seen}, {"within the arm's sight", observable}};
    if (samples_.size() > 0 && !scanned_.empty()) history.curves.push_back({"seen in truth", scanned_});
    if (parameters_.planner != "see" || result.views.empty()) return history;
    see::DensityMap<float> map(parameters_.see, 0.0);
    map.insert(merged_, 0, threads_);
    for (const Index i : map.of_class(see::PointClass::frontier))
      history.frontier.push_back(map.cloud().points[static_cast<std::size_t>(i)]);
    return history;
  }

 private:
  static void add_estimate(const std::optional<Completeness>& completeness, std::vector<double>& seen,
                           std::vector<double>& observable) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    seen.push_back(completeness ? completeness->seen : kUnknown);
    observable.push_back(completeness ? completeness->observable : kUnknown);
  }

  Parameters parameters_;
  int threads_;
  study::Samples samples_;
  std::vector<double> seen_, observable_, scanned_;
  std::vector<io::DepthPicture> depth_;
  Cloud merged_;
};

}  // namespace agrisee::cli
