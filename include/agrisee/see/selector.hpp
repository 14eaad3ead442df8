// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which proposed view is taken next (SEE++, next best view selection). Metres. Cost: O(n log tau) for n views.
#pragma once

#include <agrisee/see/visibility_graph.hpp>

#include <optional>

namespace agrisee::see {

/// A view that can be taken.
struct ViewOption {
  Index node = -1;        ///< in the visibility graph
  double distance = 0.0;  ///< from the sensor (m)
};

/// Choose a view. It is the nearest one, unless views that see its frontier see strictly more frontiers than it does:
/// then that of them which sees the most per distance. 1 mm is added to all distances. Of equal ones the first is
/// taken.
/// @return position in `options`; empty if there are none
inline std::optional<std::size_t> select_view(const std::vector<ViewOption>& options, const VisibilityGraph& graph) {
  if (options.empty()) return std::nullopt;
  const auto nearer = [](const ViewOption& a, const ViewOption& b) { return a.distance < b.distance; };
  const ViewOption& nearest = *std::min_element(options.begin(), options.end(), nearer);
  auto best = static_cast<std::size_t>(&nearest - options.data());
  const int least = graph.out_degree(nearest.node);
  double best_score = 0.0;
  for (std::size_t i = 0; i < options.size(); ++i) {
    if (!graph.arc(options[i].node, nearest.node)) continue;
    const int seen = graph.out_degree(options[i].node);
    const double score = seen / (options[i].distance + 0.001);
    if (seen <= least || score <= best_score) continue;
    best_score = score;
    best = i;
  }
  return best;
}

}  // namespace agrisee::see
