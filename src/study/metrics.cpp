// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/study/metrics.hpp>

#include <algorithm>

namespace agrisee::study {

ErrorSummary summarize(const Metrics& metrics, std::optional<double> FruitMetrics::*error) {
  ErrorSummary s;
  for (const FruitMetrics& fruit : metrics.fruits) {
    if (!(fruit.*error)) continue;
    s.mean += std::abs(*(fruit.*error));
    s.worst = std::max(s.worst, std::abs(*(fruit.*error)));
    ++s.count;
  }
  if (s.count > 0) s.mean /= s.count;
  return s;
}

std::optional<double> repeatability(const std::vector<Eigen::Vector3d>& centroids) {
  if (centroids.size() < 2) return std::nullopt;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& c : centroids) mean += c / static_cast<double>(centroids.size());
  double sum = 0.0;
  for (const auto& c : centroids) sum += (c - mean).squaredNorm();
  return std::sqrt(sum / static_cast<double>(centroids.size()));
}

}  // namespace agrisee::study
