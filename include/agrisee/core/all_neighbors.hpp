// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Neighbours of all points of a cloud at once, several times as fast as query by query: points are visited cell by
/// cell of a grid; the few whose neighbours are farther than the next cells look further by a kd-tree of the cells, and
/// those in crowds by a kd-tree of the points. Answers are those of neighbors.hpp, whatever the number of threads.
///
/// Any frame, metres. Cost O(n k) for evenly dense clouds, O(n k log n) for others; memory 20 to 50 bytes a
/// point and no lists but those returned.
#pragma once

#include <agrisee/core/far_neighbors.hpp>
#include <agrisee/core/tiles.hpp>
#include <agrisee/core/typical_distance.hpp>

#include <numeric>
#include <tuple>

namespace agrisee {

namespace detail {

/// Whether different points of a tile may have a squared distance of 0.
template <typename S>
bool squares_vanish(const Tile<S>& tile) {
  const S tiny = S(4) * std::sqrt(std::numeric_limits<S>::denorm_min()) / std::numeric_limits<S>::epsilon();
  const auto small = [&](const std::vector<S>& c) {
    return std::any_of(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(tile.size),
                       [&](S x) { return x != 0 && std::abs(x) < tiny; });
  };
  return small(tile.x) || small(tile.y) || small(tile.z);
}

/// body(j, neighbourhood) for those of the stored points [begin, end) of a cell that coincide with k - 1 others or
/// more: all that lie at one place have the same neighbours. Sensors that write missing points as zeros make many of
/// them.
template <typename S, typename Body>
void coinciding_neighborhoods(const Grid<S>& grid, std::size_t begin, std::size_t end, std::size_t k,
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
      end_at_last(near);
      for (; group != next; ++group) {
        if ((*group & 0xFFF) == 0) throw_if_cancelled();
        body(*group, near);
        done[*group] = 1;
      }
    }
    group = next;
  }
}

/// The points that near_neighborhoods leaves: their places among the stored points.
struct Left {
  Indices far;      ///< neighbours are not within two rings of cells
  Indices crowded;  ///< more points in the next cells than are worth reading
};

/// body(j, neighbourhood, rings) for the stored points j of which all neighbours are found within so many rings of
/// cells, 1 or 2; 0 where there are so many that these were found otherwise.
template <Order kOrder, typename S, typename Body>
Left near_neighborhoods(const Grid<S>& grid, std::size_t k, S radius, S typical, int threads, const Body& body) {
  constexpr char kFar = 0, kDone = 1, kCrowded = 2;
  const Stencil rings[] = {box_stencil(1), box_stencil(2)};
  const std::size_t crowd = 32 * k + 1024;
  std::vector<char> state(grid.stored(), kFar);
  for_cells(grid, threads, [&] {
    return [&, tile = Tile<S>(), nearest = TileNearest<S, kOrder>(grid, k, typical)](
               const typename Grid<S>::Cell& cell, std::size_t begin, std::size_t end) mutable {
      std::size_t left = end - begin;
      for (int r = 1; r <= 2 && left > 0; ++r) {
        tile.gather(grid, cell, rings[r - 1]);
        if (tile.size > crowd) {
          if (r == 1 && left > k && !squares_vanish(tile))
            coinciding_neighborhoods(grid, begin, end, k, state,
                                     [&](std::size_t j, const Neighborhood<S>& near) { body(j, near, 0); });
          for (std::size_t j = begin; j < end; ++j)
            if (state[j] != kDone) state[j] = kCrowded;
          return;
        }
        for (std::size_t j = begin; j < end; ++j) {
          if (state[j] == kDone) continue;
          const Vector3<S> q = grid.stored_point(j);
          const S reach = std::min(radius, static_cast<S>(grid.clearance(q, cell, r)));
          const Neighborhood<S>& near = nearest(tile, q, reach);
          const S reach_sq = reach * reach;
          const bool told =
              std::isfinite(reach_sq) && reach_sq >= std::numeric_limits<S>::min();  // who is within reach
          if (reach < radius && (near.size < k || !told)) continue;
          body(j, near, r);
          state[j] = kDone;
          --left;
        }
      }
    };
  });
  Left out;
  for (std::size_t j = 0; j < grid.stored(); ++j)
    if (state[j] != kDone) (state[j] == kFar ? out.far : out.crowded).push_back(static_cast<Index>(j));
  return out;
}

/// The finite points of a cloud on a grid in which most neighbourhoods of k points lie within a ring of cells.
template <typename S>
struct NeighborhoodGrid {
  /// @param cloud points (m)  @param k neighbours, at least 1  @param radius no neighbour is farther (m)
  /// @param threads the result does not depend on it
  template <typename C>
  NeighborhoodGrid(const C& cloud, std::size_t k, S radius, int threads)
      : typical(typical_distance(cloud, k, agrisee::size(cloud) < 500000 ? 1 : threads)),
        grid(cloud, radius > 0 ? std::min(S(1.25) * typical, S(1.00001) * radius) : S(1.25) * typical, threads) {}

  S typical;     ///< distance of the k-th nearest (m)
  Grid<S> grid;  ///< of the cloud
};

/// As for_each_neighborhood, but body(j, neighbourhood, rings) for the stored points j of the grid, see
/// near_neighborhoods; rings is 0 for those whose neighbours are not found within two rings or are too many to look
/// through.
template <Order kOrder, typename C, typename Body>
void for_stored_neighborhoods(const C& cloud, const NeighborhoodGrid<scalar_t<C>>& near, std::size_t k,
                              scalar_t<C> radius, int threads, const Body& body) {
  using S = scalar_t<C>;
  const Grid<S>& grid = near.grid;
  const Left left = near_neighborhoods<kOrder>(grid, k, radius, near.typical, threads, body);
  if (!left.far.empty()) {
    const FarCells<S> cells(grid);
    parallel_chunks(left.far.size(), threads, 64, [&](std::size_t begin, std::size_t end) {
      FarNearest<S> nearest(cells, k);
      for (std::size_t f = begin; f < end; ++f) {
        throw_if_cancelled();
        const auto j = static_cast<std::size_t>(left.far[f]);
        body(j, nearest(grid.stored_point(j), radius), 0);
      }
    });
  }
  if (!left.crowded.empty()) {
    const KdTree<S> tree(cloud);
    parallel_chunks(left.crowded.size(), threads, 64, [&](std::size_t begin, std::size_t end) {
      SearchNearest<S> nearest;
      for (std::size_t c = begin; c < end; ++c) {
        throw_if_cancelled();
        const auto j = static_cast<std::size_t>(left.crowded[c]);
        body(j, nearest(cloud, tree, grid.stored_point(j), k, radius), 0);
      }
    });
  }
}

}  // namespace detail

/// body(i, neighbourhood) for every finite point i of a cloud, in no particular order: its k >= 1 nearest points
/// (itself included) that are at most `radius` >= 0 away (m; infinite for all), of equally far ones those of lesser
/// index. A body writes only what belongs to point i.
template <Order kOrder, typename C, typename Body>
void for_each_neighborhood(const C& cloud, std::size_t k, scalar_t<C> radius, int threads, const Body& body) {
  using S = scalar_t<C>;
  const detail::NeighborhoodGrid<S> near(cloud, k, radius, threads);
  detail::for_stored_neighborhoods<kOrder>(
      cloud, near, k, radius, threads,
      [&](std::size_t j, const Neighborhood<S>& neighborhood, int) { body(near.grid.ids()[j], neighborhood); });
}

}  // namespace agrisee
