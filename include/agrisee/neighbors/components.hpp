// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Connected components of the graph that joins near points, by a concurrent union-find (Jayanti & Tarjan, PODC 2016).
/// Several threads join sets at the same time; the resulting sets do not depend on the order.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/neighbors/detail/tiles.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>
#include <vector>

namespace agrisee {

/// Disjoint sets of indices. The root of a set is its smallest index. Any number of threads may call all functions at
/// the same time.
class DisjointSets {
 public:
  /// Starts with n sets of one index each.
  explicit DisjointSets(std::size_t n) : parent_(n) {
    for (std::size_t i = 0; i < n; ++i) parent_[i].store(static_cast<Index>(i), std::memory_order_relaxed);
  }
  /// The root of the set of i.
  Index root(Index i) {
    for (Index up = parent(i); up != i;) {  // path splitting: each index visited is linked to its grandparent
      const Index above = parent(up);
      if (above != up) at(parent_, i).store(above, std::memory_order_relaxed);
      i = up;
      up = above;
    }
    return i;
  }
  /// A quick test: true if i is linked directly to `root`, which implies that it is in its set. If false, it may still
  /// be.
  bool points_to(Index i, Index root) const { return parent(i) == root; }
  /// True if member(i) is true and i is in another set than that of `root`.
  template <typename Member>
  bool apart(Index i, Index root, const Member& member) {
    return !points_to(i, root) && member(static_cast<std::size_t>(i)) && this->root(i) != root;
  }
  /// Joins the sets of a and b.
  /// @return the root of the joined set; another thread may have joined it to a further one in the meantime
  Index join(Index a, Index b) {
    for (;;) {
      a = root(a), b = root(b);
      if (a == b) return a;
      if (a < b) std::swap(a, b);
      Index expected = a;  // succeeds only if a is still a root
      if (at(parent_, a).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return b;
    }
  }

 private:
  Index parent(Index i) const { return at(parent_, i).load(std::memory_order_relaxed); }
  std::vector<std::atomic<Index>> parent_;
};

namespace detail {

/// Joins the members of grid cells with their neighbors, for join_neighbors. Each thread needs its own.
template <typename S, typename Member, typename Test>
class CellJoiner {
 public:
  /// @param half rows of the stencil, see half_stencil; the other parameters are those of join_neighbors
  CellJoiner(const GridPoints<S>& grid, const Stencil& half, DisjointSets& sets, const Member& member, const Test& test)
      : grid_(grid), half_(half), sets_(sets), member_(member), test_(test) {}

  /// The rows of a stencil to search around each cell: the cell's own row first, then the rows on one side. The pairs
  /// with cells on the other side are found from there.
  static Stencil half_stencil(const Stencil& stencil) {
    Stencil half;
    for (const StencilRow& row : stencil)
      if (row.dz < 0 || (row.dz == 0 && row.dy <= 0)) half.insert(half.begin(), row);
    return half;
  }

  /// Joins the members among the stored points [first, last) of a cell with each other and with their neighbors in the
  /// half stencil.
  void operator()(const GridCell& cell, std::size_t first, std::size_t last) {
    while (first < last && !member_(first)) ++first;
    if (first == last) return;
    bool cell_joined = false;  // all members of the cell are in one set
    for (const StencilRow& row : half_) {
      const bool own = row.dz == 0 && row.dy == 0;
      const auto run = [&](int reach) {
        return grid_.run(cell[2] - reach, cell[2] + (own ? 0 : reach), cell[1] + row.dy, cell[0] + row.dz);
      };
      const auto [begin, end] = run(row.outer);
      if (begin == end) continue;
      if (cell_joined && all_joined(begin, end, root(first))) continue;  // no pair is left to test
      auto inside = std::make_pair(end, end);  // all members of these cells are neighbors of those of the cell
      if (row.inner >= 0) inside = run(row.inner);
      if (inside.first == inside.second) inside = {end, end};
      Index mine = static_cast<Index>(first);
      for (std::size_t i = inside.first; i < inside.second; ++i)
        if (member_(i)) mine = sets_.join(mine, static_cast<Index>(i));
      for (std::size_t j = first; j < last; ++j) {
        if (!member_(j)) continue;
        const std::size_t until = own ? j : end;  // in the cell itself, the points before j
        join_near(j, begin, std::min(until, inside.first));
        join_near(j, inside.second, until);
      }
      if (own) cell_joined = all_joined(first, last, root(first));
    }
  }

 private:
  Index root(std::size_t i) { return sets_.root(static_cast<Index>(i)); }

  /// True if all members of [begin, end) are in the set of `root`.
  bool all_joined(std::size_t begin, std::size_t end, Index root) {
    for (std::size_t i = begin; i < end; ++i)
      if (sets_.apart(static_cast<Index>(i), root, member_)) return false;
    return true;
  }

  /// Tests the points [begin, end) against the member j and joins it with its neighbors.
  void join_near(std::size_t j, std::size_t begin, std::size_t end) {
    constexpr std::size_t kTestsBetweenChecks = 1 << 20;  // for cancellation
    if (begin >= end) return;
    if ((tested_ += end - begin) > kTestsBetweenChecks) throw_if_cancelled(), tested_ = 0;
    if (near_.size() < end - begin) near_.resize(end - begin), hits_.resize(end - begin);
    test_(j, begin, end, near_.data());
    std::size_t found = 0;
    for (std::size_t i = begin; i < end; ++i) {
      hits_[found] = static_cast<std::uint32_t>(i);
      found += near_[i - begin];
    }
    if (found == 0) return;
    Index mine = root(j);
    for (std::size_t i = 0; i < found; ++i) mine = sets_.join(mine, static_cast<Index>(hits_[i]));
  }

  const GridPoints<S>& grid_;
  const Stencil& half_;
  DisjointSets& sets_;
  const Member& member_;
  const Test& test_;
  std::vector<std::uint8_t> near_;   // results of `test`
  std::vector<std::uint32_t> hits_;  // the points found to be neighbors
  std::size_t tested_ = 0;           // pairs tested since the last check for cancellation
};

}  // namespace detail

/// Joins all neighbors among the stored points of a grid in `sets`. Only points for which member(j) is true take part.
/// @param grid the points
/// @param stencil the cells around a cell that may hold neighbors; all members in its inner cells are neighbors
/// @param threads the result does not depend on it
/// @param sets receives the connected points
/// @param member whether the stored point j may have neighbors
/// @param test test(j, begin, end, near) sets near[i - begin] for the stored points i of [begin, end): to 1 if i is a
///   member and a neighbor of the member j, and to 0 otherwise; it must be symmetric in i and j
template <typename S, typename Member, typename Test>
void join_neighbors(const Grid<S>& grid, const detail::Stencil& stencil, int threads, DisjointSets& sets,
                    const Member& member, const Test& test) {
  using Joiner = detail::CellJoiner<S, Member, Test>;
  const detail::Stencil half = Joiner::half_stencil(stencil);
  detail::for_cells(grid, threads, [&] { return Joiner(grid, half, sets, member, test); });
}

/// Numbers the sets of at least `min_size` members from 1, in the order of the smallest rank among their members.
/// O(n), and a sort of these sets; 12 bytes per index.
/// @param sets the sets
/// @param n number of indices
/// @param min_size sets with fewer members get no number
/// @param threads the result does not depend on it
/// @param member whether index j counts as a member; a set holds either members only or none
/// @param rank rank(j) of index j, from 0; all ranks differ
/// @return for each index the number of its set, or 0
/// @throws Cancelled
template <typename Member, typename Rank>
Labels number_sets(DisjointSets& sets, std::size_t n, std::size_t min_size, int threads, const Member& member,
                   const Rank& rank) {
  struct Set {
    Index least = std::numeric_limits<Index>::max();  // smallest rank of its members
    std::uint32_t size = 0;
  };
  std::vector<Set> by_root(n);
  std::vector<std::pair<Index, Index>> numbered;  // smallest rank and root
  for (std::size_t j = 0; j < n; ++j) {
    if ((j & 0x3FFF) == 0) throw_if_cancelled();
    if (!member(j)) continue;
    Set& set = at(by_root, sets.root(static_cast<Index>(j)));
    set.least = std::min(set.least, static_cast<Index>(rank(j)));
    ++set.size;
  }
  for (std::size_t j = 0; j < n; ++j)
    if (by_root[j].size > 0 && by_root[j].size >= min_size)
      numbered.emplace_back(by_root[j].least, static_cast<Index>(j));
  detail::sort_cancellably(numbered.begin(), numbered.end());
  Labels labels(n, 0);
  for (std::size_t c = 0; c < numbered.size(); ++c) at(labels, numbered[c].second) = static_cast<int>(c) + 1;
  const auto label = [&](std::size_t j) {
    if (!member(j)) return;
    const auto root = static_cast<std::size_t>(sets.root(static_cast<Index>(j)));
    if (root != j) labels[j] = labels[root];
  };
  parallel_for(n, threads, label, 4096);
  return labels;
}

}  // namespace agrisee
