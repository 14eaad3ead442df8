// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which views see which frontiers (SEE++, frontier visibility graph). A node stands for a frontier and the view that
/// is proposed for it; an arc from a node to another says that the view of the first sees the frontier of the second.
#pragma once

#include <agrisee/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace agrisee::see {

/// A directed graph whose arcs out of a node are replaced as a whole. Arcs to a node that was removed do not count.
class VisibilityGraph {
 public:
  /// Add a node without arcs. @return its number; no other node ever has the same
  Index add() {
    arcs_.emplace_back();
    alive_.push_back(1);
    return static_cast<Index>(arcs_.size()) - 1;
  }
  /// Remove a node with all arcs from and to it.
  void remove(Index node) {
    arcs_[at(node)] = {};
    alive_[at(node)] = 0;
  }
  /// Replace the arcs out of a node. @param to nodes, each once and none of them the node itself
  void connect(Index node, Indices to) {
    std::sort(to.begin(), to.end());
    arcs_[at(node)] = std::move(to);
  }
  /// Whether there is an arc.
  bool arc(Index from, Index to) const {
    return alive_[at(to)] && std::binary_search(arcs_[at(from)].begin(), arcs_[at(from)].end(), to);
  }
  /// Number of arcs out of a node: how many other frontiers its view sees.
  int out_degree(Index node) const {
    const Indices& to = arcs_[at(node)];
    return static_cast<int>(std::count_if(to.begin(), to.end(), [&](Index t) { return alive_[at(t)] != 0; }));
  }

 private:
  static std::size_t at(Index node) { return static_cast<std::size_t>(node); }

  std::vector<Indices> arcs_;  // per node, ascending
  std::vector<char> alive_;    // per node
};

}  // namespace agrisee::see
