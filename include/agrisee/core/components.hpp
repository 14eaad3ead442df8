// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Connected components of the graph that joins near points, by union-find (Jayanti & Tarjan, PODC 2016): threads join
/// sets at the same time, and the sets are the same in whatever order that happens.
#pragma once

#include <agrisee/core/tiles.hpp>

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>
#include <vector>

namespace agrisee {

/// Disjoint sets of indices; the smallest index of a set is its root. Any number of threads may call at once.
class DisjointSets {
 public:
  /// n sets of one each.
  explicit DisjointSets(std::size_t n) : parent_(n) {
    for (std::size_t i = 0; i < n; ++i) parent_[i].store(static_cast<Index>(i), std::memory_order_relaxed);
  }
  /// The one that stands for the set of i.
  Index root(Index i) {
    for (Index up = parent(i); up != i;) {  // each step lets i point at its grandparent
      const Index above = parent(up);
      if (above != up) parent_[static_cast<std::size_t>(i)].store(above, std::memory_order_relaxed);
      i = up;
      up = above;
    }
    return i;
  }
  /// Whether i is known to belong to `root`, at one look; false says nothing.
  bool points_to(Index i, Index root) const { return parent(i) == root; }
  /// Whether i is a member, which member(i) tells, of another set than that of `root`.
  template <typename Member>
  bool apart(Index i, Index root, const Member& member) {
    return !points_to(i, root) && member(static_cast<std::size_t>(i)) && this->root(i) != root;
  }
  /// Join the sets of a and b; the root of both, unless another thread joins more at the same time.
  Index join(Index a, Index b) {
    for (;;) {
      a = root(a), b = root(b);
      if (a == b) return a;
      if (a < b) std::swap(a, b);
      Index expected = a;  // still a root?
      if (parent_[static_cast<std::size_t>(a)].compare_exchange_strong(expected, b, std::memory_order_relaxed))
        return b;
    }
  }

 private:
  Index parent(Index i) const { return parent_[static_cast<std::size_t>(i)].load(std::memory_order_relaxed); }
  std::vector<std::atomic<Index>> parent_;
};

/// Join in `sets` all members among the stored points of a grid that are neighbours.
/// @param grid of the points
/// @param stencil cells about a cell in which neighbours may be; all members in cells that lie inside are neighbours
/// @param threads the result does not depend on it
/// @param sets receives who belongs together
/// @param member whether the stored point j may have neighbours
/// @param test test(j, begin, end, is) sets is[i - begin] to 1 for the members i of [begin, end) that are neighbours of
///   the member j and to 0 for others; it must be symmetric
template <typename S, typename Member, typename Test>
void join_neighbors(const Grid<S>& grid, const Stencil& stencil, int threads, DisjointSets& sets, const Member& member,
                    const Test& test) {
  Stencil half;  // the cell's own row, then the others of one side: from the other side the rest is seen
  for (const StencilRow& row : stencil)
    if (row.dz < 0 || (row.dz == 0 && row.dy <= 0)) half.insert(half.begin(), row);
  constexpr std::size_t kLook = 1 << 20;  // tests between looks for cancellation
  for_cells(grid, threads, [&] {
    return [&, is = std::vector<std::uint8_t>(), hits = std::vector<std::uint32_t>(), tested = std::size_t(0)](
               const typename Grid<S>::Cell& cell, std::size_t first, std::size_t last) mutable {
      while (first < last && !member(first)) ++first;
      if (first == last) return;
      const auto joined = [&](std::size_t begin, std::size_t end, Index root) {  // whether all members are, with `root`
        for (std::size_t i = begin; i < end; ++i)
          if (sets.apart(static_cast<Index>(i), root, member)) return false;
        return true;
      };
      const auto join_near = [&](std::size_t j, std::size_t begin, std::size_t end) {
        if (begin >= end) return;
        if ((tested += end - begin) > kLook) throw_if_cancelled(), tested = 0;
        if (is.size() < end - begin) is.resize(end - begin), hits.resize(end - begin);
        test(j, begin, end, is.data());
        std::size_t found = 0;
        for (std::size_t i = begin; i < end; ++i) {
          hits[found] = static_cast<std::uint32_t>(i);
          found += is[i - begin];
        }
        if (found == 0) return;
        Index mine = sets.root(static_cast<Index>(j));
        for (std::size_t i = 0; i < found; ++i) mine = sets.join(mine, static_cast<Index>(hits[i]));
      };
      bool together = false;  // all members of the cell
      for (const StencilRow& row : half) {
        const bool own = row.dz == 0 && row.dy == 0;
        const auto cells = [&](int reach) {
          return grid.run(cell[2] - reach, cell[2] + (own ? 0 : reach), cell[1] + row.dy, cell[0] + row.dz);
        };
        const auto [begin, end] = cells(row.outer);
        if (begin == end) continue;
        if (together && joined(begin, end, sets.root(static_cast<Index>(first)))) continue;  // nothing is left to test
        auto inside = std::make_pair(end, end);
        if (row.inner >= 0) inside = cells(row.inner);
        if (inside.first == inside.second) inside = {end, end};
        Index mine = static_cast<Index>(first);
        for (std::size_t i = inside.first; i < inside.second; ++i)
          if (member(i)) mine = sets.join(mine, static_cast<Index>(i));
        for (std::size_t j = first; j < last; ++j) {
          if (!member(j)) continue;
          const std::size_t until = own ? j : end;  // of the own cell the points before this one
          join_near(j, begin, std::min(until, inside.first));
          join_near(j, inside.second, until);
        }
        if (own) together = joined(first, last, sets.root(static_cast<Index>(first)));
      }
    };
  });
}

/// Number the sets of at least `min_size` members from 1, in the order of their members' least ranks. O(n) and a sort
/// of these sets; 12 bytes an index.
/// @param sets who belongs together
/// @param n how many indices
/// @param min_size sets with fewer members get no number
/// @param threads the result does not depend on it
/// @param member whether index j counts; members and others are never in one set
/// @param rank rank(j), from 0, no two alike
/// @return the number of its set an index, 0 for none
/// @throws Cancelled
template <typename Member, typename Rank>
Labels number_sets(DisjointSets& sets, std::size_t n, std::size_t min_size, int threads, const Member& member,
                   const Rank& rank) {
  struct Set {
    Index least = std::numeric_limits<Index>::max();  // rank of its members
    std::uint32_t size = 0;
  };
  std::vector<Set> by_root(n);
  std::vector<std::pair<Index, Index>> numbered;  // least rank, root
  for (std::size_t j = 0; j < n; ++j) {
    if ((j & 0x3FFF) == 0) throw_if_cancelled();
    if (!member(j)) continue;
    Set& set = by_root[static_cast<std::size_t>(sets.root(static_cast<Index>(j)))];
    set.least = std::min(set.least, static_cast<Index>(rank(j)));
    ++set.size;
  }
  for (std::size_t j = 0; j < n; ++j)
    if (by_root[j].size > 0 && by_root[j].size >= min_size)
      numbered.emplace_back(by_root[j].least, static_cast<Index>(j));
  detail::sort_cancellably(numbered.begin(), numbered.end());
  Labels labels(n, 0);
  for (std::size_t c = 0; c < numbered.size(); ++c)
    labels[static_cast<std::size_t>(numbered[c].second)] = static_cast<int>(c) + 1;
  const auto label = [&](std::size_t j) {
    if (!member(j)) return;
    const auto root = static_cast<std::size_t>(sets.root(static_cast<Index>(j)));
    if (root != j) labels[j] = labels[root];
  };
  parallel_for(n, threads, label, 4096);
  return labels;
}

}  // namespace agrisee
