// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Regions where every point grows and neighbours are the k nearest: a directed graph, as a point may be no neighbour
/// of its neighbours. A region is what its seed, the earliest point without a region, reaches. Points that are
/// neighbours of each other reach the same and are joined by union-find on all threads; a walk over the sets, from seed
/// to seed, follows the edges of one direction that remain.
#pragma once

#include <agrisee/cloud/region_rules.hpp>
#include <agrisee/core/all_neighbors.hpp>
#include <agrisee/core/components.hpp>

#include <mutex>

namespace agrisee {

namespace detail {

/// The k nearest of each stored point of a grid: the places of those that are in the cells next to its own, in two
/// bytes each, and how far the last one is.
template <typename S>
struct NearbyLists {
  static constexpr std::uint16_t kEnd = std::numeric_limits<std::uint16_t>::max();

  /// Lists of k of n points, all empty.
  NearbyLists(std::size_t n, std::size_t k) : places(n * k, kEnd), sq(n), last(n) {}
  /// Whether the point `id`, `d_sq` (m2) away, is one of the k nearest of stored point j.
  bool holds(std::size_t j, S d_sq, Index id) const { return d_sq < sq[j] || (d_sq == sq[j] && id <= last[j]); }

  std::vector<std::uint16_t> places;  ///< k a point, among the points of the cells next to its own; ends with kEnd
  std::vector<S> sq;                  ///< squared distance (m2) of the k-th nearest; infinite where there are fewer
  std::vector<Index> last;            ///< its index; of those at that distance, greater ones are none of the k
};

/// Edges of one direction between stored points.
using Edges = std::vector<std::pair<Index, Index>>;

/// Which sets are reached from which seeds.
/// @param sets points that reach one another; roots are their least indices
/// @param edges stored points; sorted on return
/// @param member whether stored point j can join
/// @param earlier earlier(i, j): whether stored point i becomes a seed before j
/// @return the region of each root, from 1 in the order of the seeds; 0 elsewhere. How many there are.
template <typename Member, typename Earlier>
std::pair<Labels, int> reached_sets(DisjointSets& sets, std::size_t n, Edges& edges, const Member& member,
                                    const Earlier& earlier) {
  constexpr Index kNone = -1;
  const auto root = [&](std::size_t j) { return static_cast<std::size_t>(sets.root(static_cast<Index>(j))); };
  std::vector<Index> seeds(n, kNone);  // of each root
  Indices roots;
  for (std::size_t j = 0; j < n; ++j) {
    if (!member(j)) continue;
    Index& seed = seeds[root(j)];
    if (seed == kNone) roots.push_back(static_cast<Index>(root(j)));
    if (seed == kNone || earlier(j, static_cast<std::size_t>(seed))) seed = static_cast<Index>(j);
  }
  const auto seed = [&](Index r) { return static_cast<std::size_t>(seeds[static_cast<std::size_t>(r)]); };
  std::sort(roots.begin(), roots.end(), [&](Index a, Index b) { return a != b && earlier(seed(a), seed(b)); });
  for (auto& [from, to] : edges) from = sets.root(from), to = sets.root(to);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  Labels regions(n, 0);
  int created = 0;
  Indices queue;
  for (const Index first : roots) {
    if (regions[static_cast<std::size_t>(first)] != 0) continue;
    regions[static_cast<std::size_t>(first)] = ++created;
    queue.assign(1, first);
    for (std::size_t head = 0; head < queue.size(); ++head) {
      if ((head & 0xFF) == 0) throw_if_cancelled();
      const Index from = queue[head];
      for (auto e = std::lower_bound(edges.begin(), edges.end(), std::make_pair(from, Index(0)));
           e != edges.end() && e->first == from; ++e) {
        int& region = regions[static_cast<std::size_t>(e->second)];
        if (region != 0) continue;
        region = created;
        queue.push_back(e->second);
      }
    }
  }
  return {std::move(regions), created};
}

/// The regions where the k nearest neighbours grow. O(n k); 2 k bytes a point and some 40 with the grid.
template <typename C>
Labels nearest_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                       const RegionGrowingParameters& params, const std::vector<scalar_t<C>>& curvatures, int threads) {
  using S = scalar_t<C>;
  constexpr S kInfinity = std::numeric_limits<S>::infinity();
  const auto k = static_cast<std::size_t>(params.neighbors);
  const NeighborhoodGrid<S> near(cloud, k, kInfinity, threads);
  const Grid<S>& grid = near.grid;
  const std::size_t n = grid.stored();
  const OrientedPoints<S> points(grid, normals, params, threads);
  const auto member = [&](std::size_t j) { return points.member(j); };
  const S *x = grid.x().data(), *y = grid.y().data(), *z = grid.z().data();
  const Index* ids = grid.ids().data();
  const auto distance_sq = [&](std::size_t i, std::size_t j) {
    const S dx = x[i] - x[j], dy = y[i] - y[j], dz = z[i] - z[j];
    return dx * dx + dy * dy + dz * dz;
  };

  NearbyLists<S> lists(n, k);
  std::mutex edges_mutex;
  Edges edges;      // stored points
  Edges far_edges;  // a stored point and the index in the cloud of one that is not beside it
  const auto keep = [&](std::size_t j, const Neighborhood<S>& neighbors, int rings) {
    const std::size_t last = neighbors.size - 1;
    lists.sq[j] = neighbors.size < k ? kInfinity : neighbors.distance_sq[last];
    lists.last[j] = neighbors.ids[last];
    if (!member(j)) return;
    if (rings == 1 && *std::max_element(neighbors.at, neighbors.at + neighbors.size) < NearbyLists<S>::kEnd) {
      for (std::size_t i = 0; i < neighbors.size; ++i)
        lists.places[j * k + i] = static_cast<std::uint16_t>(neighbors.at[i]);
      return;
    }
    const std::lock_guard<std::mutex> lock(edges_mutex);
    for (std::size_t i = 0; i < neighbors.size; ++i)
      if (neighbors.ids[i] != ids[j]) far_edges.emplace_back(static_cast<Index>(j), neighbors.ids[i]);
  };
  for_stored_neighborhoods(cloud, near, k, kInfinity, threads, keep);

  DisjointSets sets(n);
  const auto join_smooth = [&](std::size_t i, std::size_t j) {  // j is a neighbour of the member i
    const auto a = static_cast<Index>(i), b = static_cast<Index>(j);
    if (sets.root(a) == sets.root(b) || !points.smooth(i, j)) return;
    if (lists.holds(j, distance_sq(i, j), ids[i])) {
      sets.join(a, b);
    } else {
      const std::lock_guard<std::mutex> lock(edges_mutex);
      edges.emplace_back(a, b);
    }
  };
  const Stencil ring = box_stencil(1);
  for_cells(grid, threads, [&] {
    return [&, around = std::vector<std::uint32_t>()](const typename Grid<S>::Cell& cell, std::size_t first,
                                                      std::size_t last) mutable {
      const auto listed = [&](std::size_t i) { return lists.places[i * k] != NearbyLists<S>::kEnd; };
      while (first < last && !listed(first)) ++first;
      if (first == last) return;
      around.clear();
      for (const StencilRow& row : ring) {
        const auto [begin, end] =
            grid.run(cell[2] - row.outer, cell[2] + row.outer, cell[1] + row.dy, cell[0] + row.dz);
        around.resize(around.size() + (end - begin));
        std::iota(around.end() - static_cast<std::ptrdiff_t>(end - begin), around.end(),
                  static_cast<std::uint32_t>(begin));
      }
      for (std::size_t i = first; i < last; ++i)
        for (std::size_t at = i * k; at < (i + 1) * k && lists.places[at] != NearbyLists<S>::kEnd; ++at)
          join_smooth(i, around[lists.places[at]]);
    };
  });
  if (!far_edges.empty()) {
    std::vector<Index> place(agrisee::size(cloud), 0);  // of the cloud's points among the stored ones
    for (std::size_t j = 0; j < n; ++j) place[static_cast<std::size_t>(ids[j])] = static_cast<Index>(j);
    for (const auto& [i, id] : far_edges)
      join_smooth(static_cast<std::size_t>(i), static_cast<std::size_t>(place[static_cast<std::size_t>(id)]));
  }

  lists = {0, 0};

  const auto earlier = [&](std::size_t i, std::size_t j) {
    const auto a = static_cast<std::size_t>(ids[i]), b = static_cast<std::size_t>(ids[j]);
    if (!params.seeds_by_curvature || curvatures[a] == curvatures[b]) return a < b;
    return curvatures[a] < curvatures[b];
  };
  const auto [regions, created] = reached_sets(sets, n, edges, member, earlier);
  Labels labels(agrisee::size(cloud), 0);
  const auto label = [&, &of_roots = regions](std::size_t j) {
    if (member(j))
      labels[static_cast<std::size_t>(ids[j])] = of_roots[static_cast<std::size_t>(sets.root(static_cast<Index>(j)))];
  };
  parallel_for(n, threads, label, 4096);
  drop_small_regions(labels, created, params.min_size);
  return labels;
}

}  // namespace detail

}  // namespace agrisee
