// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which proposed view sees which frontiers (SEE++, frontier visibility graph). World frame, metres.
/// Cost O(views x frontiers) sight lines, each at most psi / upsilon ball queries.
#pragma once

#include <agrisee/core/parallel.hpp>
#include <agrisee/see/occlusion.hpp>

namespace agrisee::see {

/// `sees[i]`: the frontiers, by their position in the list given, that view i sees; ascending.
struct VisibilityGraph {
  std::vector<Indices> sees;  ///< of each view, the frontiers that it sees

  /// True when view i sees the frontier j.
  bool edge(std::size_t i, std::size_t j) const {
    return std::binary_search(sees[i].begin(), sees[i].end(), static_cast<Index>(j));
  }
  /// Frontiers that view i sees.
  int out_degree(std::size_t i) const { return static_cast<int>(sees[i].size()); }
};

/// A view sees a frontier when it stands within `max_incidence` of the frontier's normal and the sight line is free.
template <typename S, typename Search>
bool sees(const Search& search, const ViewProposal& view, const Frontier& f, const Parameters& params,
          const Aabb& bounds) {
  const Eigen::Vector3d line = view.position - f.point;
  // A hair more than max_incidence: the freest side of a frontier may lie on the limit itself, to its tolerance.
  if (!(line.dot(f.normal) >= (std::cos(params.max_incidence) - 0.01) * line.norm())) return false;
  return is_visible<S>(search, f.point, view.position, params, bounds);
}

/// Test every view against every frontier.
/// @param search a search with `count(q, r, cap)` of scalar S over the merged cloud; @param bounds a box that holds the
/// cloud
/// @param views the proposals
/// @param frontiers that are to be seen
/// @param params see their struct
/// @param threads the result does not depend on it
template <typename S, typename Search>
VisibilityGraph visibility_graph(const Search& search, const std::vector<ViewProposal>& views,
                                 const std::vector<Frontier>& frontiers, const Parameters& params, const Aabb& bounds,
                                 int threads = 1) {
  VisibilityGraph graph;
  graph.sees.resize(views.size());
  parallel_for(
      views.size(), threads,
      [&](std::size_t i) {
        for (std::size_t j = 0; j < frontiers.size(); ++j)
          if (sees<S>(search, views[i], frontiers[j], params, bounds)) graph.sees[i].push_back(static_cast<Index>(j));
      },
      1);
  return graph;
}

}  // namespace agrisee::see
