// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which proposed view sees which frontiers (SEE++, frontier visibility graph). World frame, metres.
/// Cost: views times frontiers lines of sight, each of at most psi / upsilon queries for the points in a ball.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/see/occlusion.hpp>

namespace agrisee::see {

/// For every view the frontiers that it sees.
struct VisibilityGraph {
  std::vector<Indices> sees;  ///< per view: positions in the list of frontiers, ascending

  /// Whether view i sees frontier j.
  bool edge(std::size_t i, std::size_t j) const {
    return std::binary_search(sees[i].begin(), sees[i].end(), static_cast<Index>(j));
  }
  /// Number of frontiers that view i sees.
  int out_degree(std::size_t i) const { return static_cast<int>(sees[i].size()); }
};

/// Whether a view sees a frontier: it is within `max_incidence` of the frontier's normal, and the line of sight is
/// free. The parameters are those of visibility_graph.
template <typename S, typename Search>
bool sees(const Search& search, const ViewProposal& view, const Frontier& f, const Parameters& parameters,
          const Aabb& bounds) {
  const Eigen::Vector3d line = view.position - f.point;
  // Slightly more than max_incidence is allowed: freest_direction may return a direction at the limit, to its
  // tolerance.
  if (!(line.dot(f.normal) >= (std::cos(parameters.max_incidence) - 0.01) * line.norm())) return false;
  return is_visible<S>(search, f.point, view.position, parameters, bounds);
}

/// Test every view against every frontier.
/// @param search a search with `count(q, r, cap)` of scalar S over the merged cloud
/// @param views the proposals
/// @param frontiers the frontiers
/// @param parameters max_incidence, psi and upsilon are used
/// @param bounds a box that holds the cloud (m, world)
/// @param threads the result does not depend on it
template <typename S, typename Search>
VisibilityGraph visibility_graph(const Search& search, const std::vector<ViewProposal>& views,
                                 const std::vector<Frontier>& frontiers, const Parameters& parameters,
                                 const Aabb& bounds, int threads = 1) {
  VisibilityGraph graph;
  graph.sees.resize(views.size());
  parallel_for(
      views.size(), threads,
      [&](std::size_t i) {
        for (std::size_t j = 0; j < frontiers.size(); ++j)
          if (sees<S>(search, views[i], frontiers[j], parameters, bounds))
            graph.sees[i].push_back(static_cast<Index>(j));
      },
      1);
  return graph;
}

}  // namespace agrisee::see
