// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Neighbours of all points of a cloud at once, several times as fast as query by query: points are visited cell by
/// cell of a grid; the few whose neighbours are farther than the next cells look further by a kd-tree of the cells, and
/// those in crowds by a kd-tree of the points. Answers are those of neighbors.hpp, whatever the number of threads.
///
/// Any frame, metres. Cost O(n k) for evenly dense clouds, O(n k log n) for others; memory some 20 bytes a point and no
/// lists but those returned.
#pragma once

#include <agrisee/core/kdtree.hpp>
#include <agrisee/core/neighborhood.hpp>
#include <agrisee/core/tiles.hpp>

#include <numeric>
#include <optional>
#include <tuple>

namespace agrisee {

namespace detail {

/// Median, over a few points of the cloud, of the distance (m) to the k-th nearest, judged by a share of the points;
/// points with that many duplicates do not count. 1 where there are no others.
template <typename C>
scalar_t<C> typical_distance(const C& cloud, std::size_t k, int threads = 1) {
  using S = scalar_t<C>;
  constexpr std::size_t kSamples = 16;
  const std::size_t n = agrisee::size(cloud), share = std::max<std::size_t>(1, k / 4);
  std::vector<Vector3<S>> some;
  for (std::size_t i = 0; i < n; i += share)
    if (is_finite(point(cloud, i))) some.push_back(point(cloud, i));
  const auto nth = [](std::vector<S>& values, std::size_t rank) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(rank, values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  std::vector<S> found(std::min(kSamples, some.size()));
  parallel_chunks(found.size(), threads, kSamples / 4, [&](std::size_t begin, std::size_t end) {
    std::vector<S> distances(some.size());
    for (std::size_t s = begin; s < end; ++s) {
      throw_if_cancelled();
      const Vector3<S> q = some[s * some.size() / kSamples];
      for (std::size_t i = 0; i < some.size(); ++i) distances[i] = distance_sq<S>(some[i], q);
      found[s] = std::sqrt(nth(distances, k / share));
    }
  });
  std::vector<S> typical;
  for (const S d : found)
    if (d > 0 && std::isfinite(d)) typical.push_back(d);
  return typical.empty() ? S(1) : nth(typical, typical.size() / 2);
}

/// Candidates for points whose neighbours are not in the next cells: a kd-tree of the occupied cells finds enough of
/// them to hold k points, and all that might hold nearer ones.
template <typename S>
class FarCells {
 public:
  explicit FarCells(const Grid<S>& grid) : grid_(grid), half_diagonal_(S(0.8661) * static_cast<S>(grid.cell())) {
    grid.cells(0, grid.stored(), [&](const typename Grid<S>::Cell& c, std::size_t begin, std::size_t end) {
      runs_.emplace_back(begin, end);
      centers_.push_back(grid.center(c));
    });
    tree_.emplace(centers_);
  }

  /// Gather a tile that holds the k nearest points to q, or all those within `radius` (m).
  void gather(const Vector3<S>& q, std::size_t k, S radius, Neighbors<S>& cells, Tile<S>& tile) const {
    S reach = radius;         // no neighbour is farther
    tree_->knn(q, k, cells);  // hold k points or more
    std::size_t points = 0, enough = 0;
    for (; enough < cells.size() && points < k; ++enough) points += size(cells[enough].index);
    if (points >= k) reach = std::min(reach, cells[enough - 1].distance + half_diagonal_);
    const S rounding = S(8) * std::numeric_limits<S>::epsilon() * (q.cwiseAbs().maxCoeff() + half_diagonal_);
    const S far = S(1.001) * (reach + half_diagonal_) + rounding;
    tile.clear();
    if (!std::isfinite(S(4) * far * far)) {  // all are wanted, or too far for S to tell how far
      tile.append(grid_, 0, grid_.stored());
      return;
    }
    tree_->visit(q, far, [&](Index c, S) {
      const auto& run = runs_[static_cast<std::size_t>(c)];
      tile.append(grid_, run.first, run.second);
    });
  }

 private:
  std::size_t size(Index c) const {
    const auto& run = runs_[static_cast<std::size_t>(c)];
    return run.second - run.first;
  }

  const Grid<S>& grid_;
  S half_diagonal_;
  std::vector<std::pair<std::size_t, std::size_t>> runs_;  // stored points of each occupied cell
  std::vector<Vector3<S>> centers_;
  std::optional<KdTree<S>> tree_;
};

/// body(j, neighbourhood) for those of the stored points [begin, end) of a cell that coincide with k - 1 others or
/// more: all that lie at one place have the same neighbours. Sensors that write missing points as zeros make many of
/// them.
template <typename S, typename Body>
void coinciding_neighborhoods(const Grid<S>& grid, std::size_t begin, std::size_t end, std::size_t k,
                              std::vector<char>& done, const Body& body) {
  std::vector<std::uint32_t> order(end - begin);
  std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(begin));
  const auto place = [&](std::uint32_t j) { return std::make_tuple(grid.x()[j], grid.y()[j], grid.z()[j]); };
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return place(a) < place(b); });
  const std::vector<S> zeros(k, S(0));
  Indices ids(k);
  for (auto group = order.begin(); group != order.end();) {
    const auto next = std::upper_bound(group, order.end(), *group, [&](auto a, auto b) { return place(a) < place(b); });
    if (static_cast<std::size_t>(next - group) >= k) {
      for (std::size_t i = 0; i < k; ++i) ids[i] = grid.ids()[group[static_cast<std::ptrdiff_t>(i)]];
      const Neighborhood<S> near{k,      zeros.data(), ids.data(), grid.x().data(), grid.y().data(), grid.z().data(),
                                 &*group};
      for (; group != next; ++group) {
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
template <typename S, typename Body>
Left near_neighborhoods(const Grid<S>& grid, std::size_t k, S radius, S typical, int threads, const Body& body) {
  constexpr char kFar = 0, kDone = 1, kCrowded = 2;
  const Stencil rings[] = {box_stencil(1), box_stencil(2)};
  const std::size_t crowd = 32 * k + 1024;
  std::vector<char> state(grid.stored(), kFar);
  for_cells(grid, threads, [&] {
    return [&, tile = Tile<S>(), nearest = TileNearest<S>(grid, k, typical)](
               const typename Grid<S>::Cell& cell, std::size_t begin, std::size_t end) mutable {
      std::size_t left = end - begin;
      for (int r = 1; r <= 2 && left > 0; ++r) {
        tile.gather(grid, cell, rings[r - 1]);
        if (tile.size > crowd) {
          if (r == 1 && left > k)
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
          if (reach < radius && (near.size < k || !std::isfinite(reach * reach))) continue;
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
      : typical(typical_distance(cloud, k, agrisee::size(cloud) < 50000 ? 1 : threads)),
        grid(cloud, radius > 0 ? std::min(S(1.25) * typical, S(1.00001) * radius) : S(1.25) * typical, threads) {}

  S typical;     ///< distance of the k-th nearest (m)
  Grid<S> grid;  ///< of the cloud
};

/// As for_each_neighborhood, but body(j, neighbourhood, rings) for the stored points j of the grid, see
/// near_neighborhoods; rings is 0 for those whose neighbours are not found within two rings or are too many to look
/// through.
template <typename C, typename Body>
void for_stored_neighborhoods(const C& cloud, const NeighborhoodGrid<scalar_t<C>>& near, std::size_t k,
                              scalar_t<C> radius, int threads, const Body& body) {
  using S = scalar_t<C>;
  const Grid<S>& grid = near.grid;
  const Left left = near_neighborhoods(grid, k, radius, near.typical, threads, body);
  if (!left.far.empty()) {
    const FarCells<S> cells(grid);
    parallel_chunks(left.far.size(), threads, 64, [&](std::size_t begin, std::size_t end) {
      Tile<S> tile;
      Neighbors<S> scratch;
      TileNearest<S> nearest(grid, k, near.typical);
      for (std::size_t f = begin; f < end; ++f) {
        const auto j = static_cast<std::size_t>(left.far[f]);
        const Vector3<S> q = grid.stored_point(j);
        cells.gather(q, k, radius, scratch, tile);
        body(j, nearest(tile, q, radius), 0);
      }
    });
  }
  if (!left.crowded.empty()) {
    const KdTree<S> tree(cloud);
    parallel_chunks(left.crowded.size(), threads, 64, [&](std::size_t begin, std::size_t end) {
      SearchNearest<S> nearest;
      for (std::size_t c = begin; c < end; ++c) {
        const auto j = static_cast<std::size_t>(left.crowded[c]);
        body(j, nearest(cloud, tree, grid.stored_point(j), k, radius), 0);
      }
    });
  }
}

}  // namespace detail

/// body(i, neighbourhood) for every finite point i of a cloud, in no particular order: its k >= 1 nearest points
/// (itself included) that are at most `radius` >= 0 away (m; infinite for all). A body writes only what belongs to
/// point i.
template <typename C, typename Body>
void for_each_neighborhood(const C& cloud, std::size_t k, scalar_t<C> radius, int threads, const Body& body) {
  using S = scalar_t<C>;
  const detail::NeighborhoodGrid<S> near(cloud, k, radius, threads);
  detail::for_stored_neighborhoods(
      cloud, near, k, radius, threads,
      [&](std::size_t j, const Neighborhood<S>& neighborhood, int) { body(near.grid.ids()[j], neighborhood); });
}

/// The k nearest points of every point of a cloud, computed once for several stages.
struct NeighborLists {
  std::size_t k = 0;  ///< neighbours a point
  Indices ids;        ///< k a point, nearest first, itself included; -1 where there are fewer and for points not finite

  /// Number of points.
  std::size_t size() const { return k == 0 ? 0 : ids.size() / k; }
  /// f(j) for the neighbours j of point i, nearest first.
  template <typename F>
  void visit(std::size_t i, F&& f) const {
    for (std::size_t j = i * k; j < (i + 1) * k && ids[j] >= 0; ++j) f(ids[j]);
  }
};

/// The neighbour lists of a cloud, for k >= 1. 4 k bytes a point.
template <typename C>
NeighborLists nearest_neighbors(const C& cloud, std::size_t k, int threads = 1) {
  using S = scalar_t<C>;
  NeighborLists out{k, Indices(agrisee::size(cloud) * k, -1)};
  for_each_neighborhood(cloud, k, std::numeric_limits<S>::infinity(), threads,
                        [&](Index i, const Neighborhood<S>& near) {
                          std::copy_n(near.ids, near.size,
                                      out.ids.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(i) * k));
                        });
  return out;
}

}  // namespace agrisee
