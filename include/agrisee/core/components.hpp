// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Connected components of the graph that joins near points, by union-find (Jayanti & Tarjan, PODC 2016): threads join
/// sets at the same time, and the sets are the same in whatever order that happens.
#pragma once

#include <agrisee/core/tiles.hpp>

#include <atomic>

namespace agrisee {

/// Disjoint sets of indices; the smallest index of a set is its root. Any number of threads may call at once.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) {
    for (std::size_t i = 0; i < n; ++i) parent_[i].store(static_cast<Index>(i), std::memory_order_relaxed);
  }
  Index root(Index i) {
    for (Index up = parent(i); up != i;) {  // each step lets i point at its grandparent
      const Index above = parent(up);
      if (above != up) parent_[static_cast<std::size_t>(i)].store(above, std::memory_order_relaxed);
      i = up;
      up = above;
    }
    return i;
  }
  /// Join the sets of a and b; the root of both, unless another thread joins more at the same time.
  Index join(Index a, Index b) {
    for (;;) {
      a = root(a), b = root(b);
      if (a == b) return a;
      if (a < b) std::swap(a, b);
      Index expected = a;  // still a root?
      if (parent_[static_cast<std::size_t>(a)].compare_exchange_strong(expected, b, std::memory_order_relaxed)) return b;
    }
  }

 private:
  Index parent(Index i) const { return parent_[static_cast<std::size_t>(i)].load(std::memory_order_relaxed); }
  std::vector<std::atomic<Index>> parent_;
};

/// Join in `sets` all stored points of a grid that are neighbours. `test(j, begin, end, is)` sets is[i - begin] to 1 for
/// the stored points i of [begin, end) that are neighbours of j and to 0 for others; it must be symmetric.
/// @param stencil cells about a cell in which neighbours may be
template <typename S, typename Test>
void join_neighbors(const Grid<S>& grid, const Stencil& stencil, int threads, DisjointSets& sets, const Test& test) {
  for_cells(grid, threads, [&] {
    return [&, is = std::vector<std::uint8_t>(), hits = std::vector<std::uint32_t>()](
               const typename Grid<S>::Cell& cell, std::size_t first, std::size_t last) mutable {
      for (const StencilRow& row : stencil) {  // the other half of the pairs is seen from the other side
        if (row.dz > 0 || (row.dz == 0 && row.dy > 0)) continue;
        const bool own = row.dz == 0 && row.dy == 0;
        const auto [begin, end] =
            grid.run(cell[2] - row.outer, cell[2] + (own ? 0 : row.outer), cell[1] + row.dy, cell[0] + row.dz);
        if (begin == end) continue;
        is.resize(std::max(is.size(), end - begin)), hits.resize(is.size());
        for (std::size_t j = first; j < last; ++j) {
          const std::size_t n = (own ? j : end) - begin;
          test(j, begin, begin + n, is.data());
          std::size_t found = 0;
          for (std::size_t i = 0; i < n; ++i) {
            hits[found] = static_cast<std::uint32_t>(begin + i);
            found += is[i];
          }
          if (found == 0) continue;
          Index mine = sets.root(static_cast<Index>(j));
          for (std::size_t i = 0; i < found; ++i) mine = sets.join(mine, static_cast<Index>(hits[i]));
        }
      }
    };
  });
}

}  // namespace agrisee
