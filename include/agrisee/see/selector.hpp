// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The order in which the proposed views are tried (SEE++, next best view selection). World frame, metres. Cost:
/// O(n log n) for n views.
#pragma once

#include <agrisee/see/visibility_graph.hpp>

#include <numeric>

namespace agrisee::see {

/// Rank the views, best first.
///
/// The view nearest to the sensor comes first, together with those that see its frontier or whose frontier it sees. All
/// others follow. Both groups are ordered by the number of frontiers seen per metre moved, largest first; views of
/// equal score stay in the given order. View i is the one proposed for frontier i.
/// @param views the proposals; receive their `visible` and `score`
/// @param graph which views see which frontiers
/// @param sensor present position of the sensor (m, world)
/// @param least_move shorter moves count as this long (m), above 0
/// @return positions in `views`
/// @throws InputError if the graph does not have one node per view
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
