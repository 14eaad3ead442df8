// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The order in which to try the proposed views (SEE++, next best view selection). Cost O(n log n) for n views.
#pragma once

#include <agrisee/see/visibility_graph.hpp>

#include <numeric>

namespace agrisee::see {

/// Positions of the views, best first, and their `visible` and `score` filled in.
///
/// First the neighbours in the graph of the view nearest to the sensor: those that see its frontier, or whose frontier
/// it sees, and itself. Then all others. Both by falling number of frontiers seen per metre moved; ties by position.
/// View i is the one proposed for frontier i.
/// @param views proposals
/// @param graph which proposals see which frontiers
/// @param sensor its present position (m)
/// @param least_move moves shorter than this (m, > 0) count as this long
/// @throws InputError when the graph has not one node a view
inline std::vector<std::size_t> rank(std::vector<ViewProposal>& views, const VisibilityGraph& graph,
                                     const Eigen::Vector3d& sensor, double least_move) {
  check_input(graph.sees.size() == views.size(), "rank: the graph has not as many nodes as there are views");
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::size_t nearest = 0;
  double nearest_distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double distance = (views[i].position - sensor).norm();
    views[i].visible = graph.out_degree(i);
    views[i].score = views[i].visible / std::max(distance, least_move);
    if (distance < nearest_distance) {
      nearest_distance = distance;
      nearest = i;
    }
  }
  const auto adjacent = [&](std::size_t i) { return i == nearest || graph.edge(i, nearest) || graph.edge(nearest, i); };
  const auto others = std::stable_partition(order.begin(), order.end(), adjacent);
  const auto better = [&](std::size_t a, std::size_t b) { return views[a].score > views[b].score; };
  std::stable_sort(order.begin(), others, better);
  std::stable_sort(others, order.end(), better);
  return order;
}

}  // namespace agrisee::see
