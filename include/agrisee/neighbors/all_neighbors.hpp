// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The nearest points of all points of a cloud, several times as fast as one query per point. Points are processed cell
/// by cell of a grid; most find their neighbors within two rings of cells. Points in sparse places search a kd-tree of
/// the occupied cells, and points in very dense places a kd-tree of the points. The results are those of a search as in
/// neighbors.hpp, for any number of threads.
///
/// Any frame; metres. O(n k) for clouds of even density, O(n k log n) otherwise. Memory: 20 to 50 bytes per point, and
/// no lists of neighbors unless they are returned.
#pragma once

#include <agrisee/neighbors/detail/cell_tree.hpp>
#include <agrisee/neighbors/detail/k_nearest.hpp>
#include <agrisee/neighbors/detail/tiles.hpp>
#include <agrisee/neighbors/detail/typical_distance.hpp>
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/neighbors/neighborhood.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>

namespace agrisee {

namespace detail {

/// True if the squared distance of two different points of a tile may underflow to 0.
template <typename S>
bool squares_vanish(const Tile<S>& tile) {
  const S tiny = S(4) * std::sqrt(std::numeric_limits<S>::denorm_min()) / std::numeric_limits<S>::epsilon();
  const auto small = [&](const std::vector<S>& c) {
    return std::any_of(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(tile.size),
                       [&](S x) { return x != 0 && std::abs(x) < tiny; });
  };
  return small(tile.x) || small(tile.y) || small(tile.z);
}

/// Handles points that coincide with at least k - 1 others; such points share their neighbors. There are many of them
/// in clouds of sensors that write missing points as zeros.
/// @param begin,end stored points of one cell
/// @param done receives a 1 for each point handled
/// @param body called as body(j, neighborhood) for each of these stored points j
template <typename S, typename Body>
void coinciding_neighborhoods(const GridPoints<S>& grid, std::size_t begin, std::size_t end, std::size_t k,
                              std::vector<char>& done, const Body& body) {
  std::vector<std::uint32_t> order(end - begin);
  std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(begin));
  const auto place = [&](std::uint32_t j) { return std::make_tuple(grid.x()[j], grid.y()[j], grid.z()[j]); };
  sort_cancellably(order.begin(), order.end(), [&](auto a, auto b) {
    const auto p = place(a), q = place(b);
    return p < q || (p == q && a < b);
  });
  const std::vector<S> zeros(k, S(0));
  for (auto group = order.begin(); group != order.end();) {
    const auto next = std::upper_bound(group, order.end(), *group, [&](auto a, auto b) { return place(a) < place(b); });
    if (static_cast<std::size_t>(next - group) >= k) {
      Neighborhood<S> near{k,       zeros.data(),     &*group, grid.x().data(), grid.y().data(), grid.z().data(),
                           nullptr, grid.ids().data()};
      bound_by_last(near);
      for (; group != next; ++group) {
        if ((*group & 0xFFF) == 0) throw_if_cancelled();
        body(*group, near);
        done[*group] = 1;
      }
    }
    group = next;
  }
}

/// Stored points whose neighbors were not found in the cells around them.
struct RemainingPoints {
  Indices sparse;  ///< points with neighbors beyond two rings of cells
  Indices dense;   ///< points with too many candidates in the cells around them to test them all
};

/// Finds the neighbors that lie within one or two rings of cells.
/// @param typical about the distance (m) of the k-th nearest point
/// @param body called as body(j, neighborhood, rings) for each stored point j whose neighbors were found; rings is the
///   number of rings needed, or 0 for points that coincide with many others
/// @return the points for which body was not called
template <Order kOrder, typename S, typename Body>
RemainingPoints near_neighborhoods(const GridPoints<S>& grid, std::size_t k, S radius, S typical, int threads,
                                   const Body& body) {
  constexpr char kSparse = 0, kDone = 1, kDense = 2;
  const Stencil stencils[] = {box_stencil(1), box_stencil(2)};
  const std::size_t max_candidates = 32 * k + 1024;
  std::vector<char> state(grid.stored(), kSparse);
  for_cells(grid, threads, [&] {
    return [&, tile = Tile<S>(), nearest = TileNearest<S, kOrder>(grid, k, typical)](
               const GridCell& cell, std::size_t begin, std::size_t end) mutable {
      std::size_t remaining = end - begin;
      for (int rings = 1; rings <= 2 && remaining > 0; ++rings) {
        tile.gather(grid, cell, stencils[rings - 1]);
        if (tile.size > max_candidates) {
          if (rings == 1 && remaining > k && !squares_vanish(tile))
            coinciding_neighborhoods(grid, begin, end, k, state,
                                     [&](std::size_t j, const Neighborhood<S>& near) { body(j, near, 0); });
          for (std::size_t j = begin; j < end; ++j)
            if (state[j] != kDone) state[j] = kDense;
          return;
        }
        for (std::size_t j = begin; j < end; ++j) {
          if (state[j] == kDone) continue;
          const Vector3<S> q = grid.stored_point(j);
          const S reach = std::min(radius, static_cast<S>(grid.clearance(q, cell, rings)));  // all within it are known
          const Neighborhood<S>& near = nearest(tile, q, reach);
          const S reach_sq = reach * reach;
          const bool square_valid = std::isfinite(reach_sq) && reach_sq >= std::numeric_limits<S>::min();
          if (reach < radius && (near.size < k || !square_valid)) continue;
          body(j, near, rings);
          state[j] = kDone;
          --remaining;
        }
      }
    };
  });
  RemainingPoints out;
  for (std::size_t j = 0; j < grid.stored(); ++j)
    if (state[j] != kDone) (state[j] == kSparse ? out.sparse : out.dense).push_back(static_cast<Index>(j));
  return out;
}

/// A grid over a cloud with cells such that most points have their k nearest within one ring of cells.
template <typename S>
struct NeighborhoodGrid {
  /// @param cloud points (m), any cloud type
  /// @param k number of neighbors, at least 1
  /// @param radius largest distance of a neighbor (m)
  /// @param threads the result does not depend on it
  template <typename C>
  NeighborhoodGrid(const C& cloud, std::size_t k, S radius, int threads)
      : typical(typical_distance(cloud, k, agrisee::size(cloud) < 500000 ? 1 : threads)),
        grid(cloud, radius > 0 ? std::min(S(1.25) * typical, S(1.00001) * radius) : S(1.25) * typical, threads) {}

  S typical;     ///< about the distance of the k-th nearest point (m)
  Grid<S> grid;  ///< the points of the cloud
};

/// As for_each_neighborhood, but with a ready-made grid. It calls body(j, neighborhood, rings) for the stored points j
/// of the grid, where rings is 1 or 2 if the neighbors were found within so many rings of cells, and 0 otherwise.
template <Order kOrder, typename C, typename Body>
void for_stored_neighborhoods(const C& cloud, const NeighborhoodGrid<scalar_t<C>>& near, std::size_t k,
                              scalar_t<C> radius, int threads, const Body& body) {
  using S = scalar_t<C>;
  const Grid<S>& grid = near.grid;
  const RemainingPoints remaining = near_neighborhoods<kOrder>(grid, k, radius, near.typical, threads, body);
  if (!remaining.sparse.empty()) {
    const CellTree<S> cells(grid);
    parallel_chunks(remaining.sparse.size(), threads, 64, [&](std::size_t begin, std::size_t end) {
      CellTreeNearest<S> nearest(cells, k);
      for (std::size_t i = begin; i < end; ++i) {
        throw_if_cancelled();
        const auto j = static_cast<std::size_t>(remaining.sparse[i]);
        body(j, nearest(grid.stored_point(j), radius), 0);
      }
    });
  }
  if (!remaining.dense.empty()) {
    const KdTree<S> tree(cloud);
    parallel_chunks(remaining.dense.size(), threads, 64, [&](std::size_t begin, std::size_t end) {
      SearchNearest<S> nearest;
      for (std::size_t i = begin; i < end; ++i) {
        throw_if_cancelled();
        const auto j = static_cast<std::size_t>(remaining.dense[i]);
        body(j, nearest(cloud, tree, grid.stored_point(j), k, radius), 0);
      }
    });
  }
}

}  // namespace detail

/// Calls body(i, neighborhood) for every finite point i of a cloud, in no particular order. The neighborhood holds the
/// k >= 1 nearest points (including the point itself) that are at most `radius` >= 0 away (m; may be infinite). Of
/// equally far points, those with smaller indices come first. body runs on up to `threads` threads and may write only
/// what belongs to point i.
template <Order kOrder, typename C, typename Body>
void for_each_neighborhood(const C& cloud, std::size_t k, scalar_t<C> radius, int threads, const Body& body) {
  using S = scalar_t<C>;
  const detail::NeighborhoodGrid<S> near(cloud, k, radius, threads);
  detail::for_stored_neighborhoods<kOrder>(
      cloud, near, k, radius, threads,
      [&](std::size_t j, const Neighborhood<S>& neighborhood, int) { body(near.grid.ids()[j], neighborhood); });
}

}  // namespace agrisee
