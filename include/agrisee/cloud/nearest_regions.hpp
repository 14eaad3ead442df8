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

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <utility>

namespace agrisee {

namespace detail {

/// Which points are the k nearest of each stored point of a grid: those up to the last of them. A tenth of the lists'
/// memory; who is asked about again is told by its distance.
template <typename S>
struct NearestReach {
  /// Of n points, to be written.
  explicit NearestReach(std::size_t n) : rings(n) { sq.resize(n), last.resize(n); }
  /// Whether the point `id`, `d_sq` (m2) away, is one of the k nearest of stored point j.
  bool holds(std::size_t j, S d_sq, Index id) const { return d_sq < sq[j] || (d_sq == sq[j] && id <= last[j]); }

  std::vector<std::atomic<char>> rings;  ///< of cells in which the k are found, 1 or 2; 0: not known yet, or see `far`
  Uninitialized<S> sq;                   ///< squared distance (m2) up to which points are; infinite where all are
  Uninitialized<Index> last;             ///< of those at that distance, greater indices are none of the k
  Indices far;                           ///< k + 1 a stored point: itself, then its neighbours, stored points, or -1
};

/// Edges of one direction between stored points.
using Edges = std::vector<std::pair<Index, Index>>;

/// Which sets are reached from which seeds. O(n + m log m) for m sets and edges.
/// @param sets points that reach one another
/// @param n how many points
/// @param edges between stored points; on return between the roots of sets, each once
/// @param member whether stored point j can join
/// @param key_of what seeds are sorted by, seed_key of stored point j
/// @return the region of each root, from 1 in the order of the seeds; 0 elsewhere. How many there are.
template <typename Member, typename KeyOf>
std::pair<Labels, int> reached_sets(DisjointSets& sets, std::size_t n, Edges& edges, const Member& member,
                                    const KeyOf& key_of) {
  struct Seed {
    decltype(key_of(n)) key;
    Index root;
  };
  std::vector<Seed> seeds;  // the earliest member of each set
  Indices seed_of(n, -1);   // of each root
  for (std::size_t j = 0; j < n; ++j) {
    if ((j & 0x3FFF) == 0) throw_if_cancelled();
    if (!member(j)) continue;
    const Seed mine{key_of(j), sets.root(static_cast<Index>(j))};
    Index& seed = seed_of[static_cast<std::size_t>(mine.root)];
    if (seed < 0) {
      seed = static_cast<Index>(seeds.size());
      seeds.push_back(mine);
    } else if (mine.key < seeds[static_cast<std::size_t>(seed)].key) {
      seeds[static_cast<std::size_t>(seed)] = mine;
    }
  }
  sort_cancellably(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.key < b.key; });
  for (auto& [from, to] : edges) from = sets.root(from), to = sets.root(to);
  edges.erase(std::remove_if(edges.begin(), edges.end(), [](const auto& e) { return e.first == e.second; }),
              edges.end());
  sort_cancellably(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  Labels regions(n, 0);
  int created = 0;
  Indices queue;
  for (const auto& [ignored, first] : seeds) {
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

/// The reach of the points of a grid; see there.
/// @param found found(j, neighbourhood, reach) for those found within rings of cells, once the reach of j is known
template <typename C, typename Found>
NearestReach<scalar_t<C>> nearest_reach(const C& cloud, const NeighborhoodGrid<scalar_t<C>>& near, std::size_t k,
                                        int threads, const Found& found) {
  using S = scalar_t<C>;
  constexpr S kInfinity = std::numeric_limits<S>::infinity();
  const Grid<S>& grid = near.grid;
  NearestReach<S> reach(grid.stored());
  std::mutex far_mutex;
  const auto keep = [&](std::size_t j, const Neighborhood<S>& its, int rings) {
    const bool all = its.size < k;  // there are no more points
    reach.sq[j] = all ? kInfinity : its.last_sq;
    reach.last[j] = all ? std::numeric_limits<Index>::max() : its.last;
    if (rings > 0) {
      reach.rings[j].store(static_cast<char>(rings), std::memory_order_release);
      found(j, its, reach);
      return;
    }
    const std::lock_guard<std::mutex> lock(far_mutex);
    reach.far.push_back(static_cast<Index>(j));
    for (std::size_t f = 0; f < its.size; ++f) reach.far.push_back(its.id(f));
    reach.far.resize(reach.far.size() + (k - its.size), -1);
  };
  for_stored_neighborhoods<Order::any>(cloud, near, k, kInfinity, threads, keep);
  if (reach.far.empty()) return reach;
  Indices stored(agrisee::size(cloud));  // of the cloud's points
  for (std::size_t j = 0; j < grid.stored(); ++j)
    stored[static_cast<std::size_t>(grid.ids()[j])] = static_cast<Index>(j);
  for (std::size_t f = 0; f < reach.far.size(); ++f)
    if (f % (k + 1) > 0 && reach.far[f] >= 0) reach.far[f] = stored[static_cast<std::size_t>(reach.far[f])];
  return reach;
}

/// The regions where the k nearest neighbours grow. O(n k), and a sort of the edges of one direction between points
/// that are not neighbours of each other; some 50 bytes a point, 4 k for points that are crowded or astray.
template <typename C>
Labels nearest_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                       const RegionGrowingParameters& params, const std::vector<scalar_t<C>>& curvatures, int threads) {
  using S = scalar_t<C>;
  const std::size_t size = agrisee::size(cloud);
  const std::size_t k = std::min(static_cast<std::size_t>(params.neighbors), std::max<std::size_t>(size, 1));
  const NeighborhoodGrid<S> near(cloud, k, std::numeric_limits<S>::infinity(), threads);
  const Grid<S>& grid = near.grid;
  const std::size_t n = grid.stored();
  const auto& ids = grid.ids();
  const OrientedPoints<S> points(grid, normals, params, threads);
  const auto member = [&](std::size_t j) { return points.member(j); };

  // Most sets are joined by the neighbours at hand, as soon as the reach of both is known; the first few of them
  // suffice: those of the rows before, which come first, mostly have been looked at.
  constexpr std::size_t kFirst = 9;
  DisjointSets sets(n);
  const auto join_known = [&](std::size_t j, const Neighborhood<S>& its, const NearestReach<S>& reach) {
    if (!member(j)) return;
    Index mine = sets.root(static_cast<Index>(j));
    for (std::size_t f = 0; f < std::min(its.size, kFirst); ++f) {
      const std::size_t i = its.stored[its.at[f]];
      if (reach.rings[i].load(std::memory_order_acquire) == 0 || sets.root(static_cast<Index>(i)) == mine) continue;
      if (reach.holds(i, its.distance_sq[f], ids[j]) && points.smooth(i, j))
        mine = sets.join(mine, static_cast<Index>(i));
    }
  };
  NearestReach<S> reach = nearest_reach(cloud, near, k, threads, join_known);

  // What is left are neighbours of different sets, found by their distances.
  std::mutex edges_mutex;
  Edges edges;
  const auto add = [&](const Edges& some) {
    if (some.empty()) return;
    const std::lock_guard<std::mutex> lock(edges_mutex);
    edges.insert(edges.end(), some.begin(), some.end());
  };
  // j, the square root of d_sq (m) away, is a neighbour of i.
  const auto join_smooth = [&](std::size_t i, std::size_t j, S d_sq, Edges& one_way) {
    const Index a = sets.root(static_cast<Index>(i)), b = sets.root(static_cast<Index>(j));
    if (a == b || !points.smooth(i, j)) return;
    if (reach.holds(j, d_sq, ids[i]))
      sets.join(a, b);
    else if (one_way.empty() || one_way.back() != std::make_pair(a, b))
      one_way.emplace_back(a, b);
  };
  const Stencil stencils[] = {box_stencil(1), box_stencil(2)};
  constexpr std::size_t kOneByOne = 16;  // others, or tile by tile
  for_cells(grid, threads, [&] {
    return [&, tile = Tile<S>(), sq = std::vector<S>(), within = std::vector<std::uint32_t>(), others = Indices(),
            one_way = Edges()](const typename Grid<S>::Cell& cell, std::size_t first, std::size_t last) mutable {
      one_way.clear();
      for (int rings = 1; rings <= 2; ++rings) {
        const auto grows = [&](std::size_t i) {
          return reach.rings[i].load(std::memory_order_relaxed) == rings && member(i);
        };
        std::size_t i = first;
        while (i < last && !grows(i)) ++i;
        if (i == last) continue;
        const Index most = sets.root(static_cast<Index>(i));
        others.clear();
        for (const StencilRow& row : stencils[rings - 1]) {
          const auto [begin, end] =
              grid.run(cell[2] - row.outer, cell[2] + row.outer, cell[1] + row.dy, cell[0] + row.dz);
          for (auto j = static_cast<Index>(begin); j < static_cast<Index>(end); ++j)
            if (sets.apart(j, most, member)) others.push_back(j);
        }
        if (others.empty()) continue;
        tile.size = 0;
        for (; i < last; ++i) {
          if (!grows(i)) continue;
          const Vector3<S> p = grid.stored_point(i);
          if (others.size() <= kOneByOne && sets.root(static_cast<Index>(i)) == most) {
            for (const Index o : others) {
              const auto j = static_cast<std::size_t>(o);
              const S d_sq = distance_sq<S>(grid.stored_point(j), p);
              if (reach.holds(i, d_sq, ids[j])) join_smooth(i, j, d_sq, one_way);
            }
            continue;
          }
          if (tile.size == 0) tile.gather(grid, cell, stencils[rings - 1]);
          if (sq.size() < tile.padded()) sq.resize(2 * tile.padded()), within.resize(2 * tile.padded());
          tile.distances_sq(p, sq.data());
          const std::size_t found = tile.list_within(sq.data(), reach.sq[i], within.data());
          for (std::size_t f = 0; f < found; ++f) {
            const std::size_t c = within[f];
            const std::size_t j = tile.at[c];
            if (reach.holds(i, sq[c], ids[j])) join_smooth(i, j, sq[c], one_way);
          }
        }
      }
      add(one_way);
    };
  });
  const auto join_far = [&](std::size_t begin, std::size_t end) {
    Edges one_way;
    for (std::size_t f = begin; f < end; ++f) {
      const auto i = static_cast<std::size_t>(reach.far[f * (k + 1)]);
      if (!member(i)) continue;
      for (std::size_t at = f * (k + 1) + 1; at < (f + 1) * (k + 1) && reach.far[at] >= 0; ++at) {
        const auto j = static_cast<std::size_t>(reach.far[at]);
        join_smooth(i, j, distance_sq<S>(grid.stored_point(i), grid.stored_point(j)), one_way);
      }
    }
    add(one_way);
  };
  parallel_chunks(reach.far.size() / (k + 1), threads, 256, join_far);
  reach = NearestReach<S>(0);  // its memory

  Uninitialized<S> curvature(params.seeds_by_curvature ? n : 0);  // of the stored points
  const auto gather = [&](std::size_t j) { curvature[j] = curvatures[static_cast<std::size_t>(ids[j])]; };
  parallel_for(curvature.size(), threads, gather, 4096);
  const auto key_of = [&](std::size_t j) {
    return std::make_pair(seed_key(j, params.seeds_by_curvature, curvature).first, ids[j]);
  };
  const auto [regions, created] = reached_sets(sets, n, edges, member, key_of);
  Labels labels(size, 0);
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
