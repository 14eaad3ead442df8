// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Region growing if every point grows and the neighbors of a point are its k nearest points. This is a directed graph:
/// a point need not be a neighbor of its own neighbors. A region is what its seed reaches, the seed being the earliest
/// point that has no region yet.
///
/// Two points that are neighbors of each other reach the same points. They are put into one set by union-find, on all
/// threads. The remaining edges lead from one set to another in one direction only; a walk along them, from seed to
/// seed, turns the sets into regions.
#pragma once

#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/region_rules.hpp>
#include <agrisee/neighbors/all_neighbors.hpp>
#include <agrisee/neighbors/components.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <utility>

namespace agrisee {

namespace detail {

/// Which points are the k nearest of each stored point of a grid, given by the distance of the last of them. This takes
/// a tenth of the memory of neighbor lists; to ask whether a point is one of the k, give its distance.
template <typename S>
struct NearestReach {
  /// For n stored points; `sq` and `last` are left for the caller to fill.
  explicit NearestReach(std::size_t n) : rings(n) { sq.resize(n), last.resize(n); }
  /// Whether the point with index `id`, sqrt(d_sq) (m) away, is one of the k nearest of stored point j.
  bool holds(std::size_t j, S d_sq, Index id) const { return d_sq < sq[j] || (d_sq == sq[j] && id <= last[j]); }

  /// Rings of cells within which the k nearest are found, 1 or 2. 0: not known yet, or the point is listed in `far`.
  std::vector<std::atomic<char>> rings;
  Uninitialized<S> sq;        ///< squared distance (m2) of the last of the k; infinite if there are fewer than k points
  Uninitialized<Index> last;  ///< of the points at just that distance, those with a greater index are not of the k
  /// Points whose k nearest are not found by rings, k + 1 entries each: the stored point itself, then its neighbors
  /// (stored points), then -1 if there are fewer than k.
  Indices far;
};

/// Edges from a stored point to another, in one direction.
using Edges = std::vector<std::pair<Index, Index>>;

/// Walk from seed to seed over sets of points and the edges between them. O(n + m log m) for m sets and edges.
/// @param sets points that reach one another
/// @param n number of stored points
/// @param edges between stored points; on return between the roots of sets, each once
/// @param member whether stored point j can join a region
/// @param key_of seeds are sorted by this key of stored point j (see seed_key)
/// @return the region of each root, from 1 in the order of the seeds, and 0 elsewhere
template <typename Member, typename KeyOf>
Labels reached_sets(DisjointSets& sets, std::size_t n, Edges& edges, const Member& member, const KeyOf& key_of) {
  struct Seed {
    decltype(key_of(n)) key;
    Index root;
  };
  std::vector<Seed> seeds;  // the earliest member of each set
  Indices seed_of(n, -1);   // of each root, an index into `seeds`
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
  return regions;
}

/// Find the reach of all points of a grid.
/// @param found found(j, neighborhood, reach) is called for each point whose k nearest are found by rings, after its
///   own reach is entered
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
  Indices stored(agrisee::size(cloud));  // where the cloud's points are stored
  for (std::size_t j = 0; j < grid.stored(); ++j)
    stored[static_cast<std::size_t>(grid.ids()[j])] = static_cast<Index>(j);
  for (std::size_t f = 0; f < reach.far.size(); ++f)
    if (f % (k + 1) > 0 && reach.far[f] >= 0) reach.far[f] = stored[static_cast<std::size_t>(reach.far[f])];
  return reach;
}

/// Joins the points of a grid that are neighbors of each other, and lists the edges of one direction that remain.
template <typename S>
class NearestSets {
 public:
  /// @param grid the points, in cells such that most have their k nearest within one ring
  /// @param points the same points with their normals
  NearestSets(const Grid<S>& grid, const OrientedPoints<S>& points)
      : grid_(grid), points_(points), sets_(grid.stored()), reach_(0) {}

  /// Fill the sets and the edges.
  template <typename C>
  void join(const C& cloud, const NeighborhoodGrid<S>& near, std::size_t k, int threads) {
    reach_ = nearest_reach(
        cloud, near, k, threads,
        [&](std::size_t j, const Neighborhood<S>& its, const NearestReach<S>& reach) { join_known(j, its, reach); });
    // What is left are neighbors in different sets. Their points are looked up again, by their distances.
    for_cells(grid_, threads, [&] {
      return
          [this, scratch = Scratch()](const typename Grid<S>::Cell& cell, std::size_t first, std::size_t last) mutable {
            scratch.one_way.clear();
            for (int rings = 1; rings <= 2; ++rings) join_cell(cell, first, last, rings, scratch);
            add(scratch.one_way);
          };
    });
    parallel_chunks(reach_.far.size() / (k + 1), threads, 256,
                    [&](std::size_t begin, std::size_t end) { join_far(begin, end, k); });
    reach_ = NearestReach<S>(0);  // frees its memory
  }

  /// Who belongs together.
  DisjointSets& sets() { return sets_; }
  /// The edges between points of different sets.
  Edges& edges() { return edges_; }

 private:
  /// What a thread keeps from cell to cell, to save allocations.
  struct Scratch {
    Tile<S> tile;
    std::vector<S> sq;
    std::vector<std::uint32_t> within;
    Indices others;
    Edges one_way;
  };

  Index root(std::size_t j) { return sets_.root(static_cast<Index>(j)); }

  /// Join point j with those of its neighbors whose own reach is known already. The first few suffice: points near each
  /// other share most of their neighbors.
  void join_known(std::size_t j, const Neighborhood<S>& its, const NearestReach<S>& reach) {
    constexpr std::size_t kFirst = 9;
    if (!points_.member(j)) return;
    Index mine = root(j);
    for (std::size_t f = 0; f < std::min(its.size, kFirst); ++f) {
      const std::size_t i = its.stored[its.at[f]];
      if (reach.rings[i].load(std::memory_order_acquire) == 0 || root(i) == mine) continue;
      if (reach.holds(i, its.distance_sq[f], grid_.ids()[j]) && points_.smooth(i, j))
        mine = sets_.join(mine, static_cast<Index>(i));
    }
  }

  /// Join point i and its neighbor j, sqrt(d_sq) (m) away, if the normals allow it; if i is not a neighbor of j in
  /// turn, note the edge instead.
  void join_smooth(std::size_t i, std::size_t j, S d_sq, Edges& one_way) {
    const Index a = root(i), b = root(j);
    if (a == b || !points_.smooth(i, j)) return;
    if (reach_.holds(j, d_sq, grid_.ids()[i]))
      sets_.join(a, b);
    else if (one_way.empty() || one_way.back() != std::make_pair(a, b))
      one_way.emplace_back(a, b);
  }

  /// Join those of the points [first, last) of a cell whose k nearest lie within exactly `rings` rings of cells.
  void join_cell(const typename Grid<S>::Cell& cell, std::size_t first, std::size_t last, int rings, Scratch& scratch) {
    constexpr std::size_t kOneByOne = 16;  // up to this many others are tested one by one, more as a tile
    const auto grows = [&](std::size_t i) {
      return reach_.rings[i].load(std::memory_order_relaxed) == rings && points_.member(i);
    };
    std::size_t i = first;
    while (i < last && !grows(i)) ++i;
    if (i == last) return;
    const Index most = root(i);  // the set to which most points near here belong
    const Stencil& stencil = stencils_[rings - 1];
    list_others(cell, stencil, most, scratch.others);
    if (scratch.others.empty()) return;
    scratch.tile.size = 0;
    for (; i < last; ++i) {
      if (!grows(i)) continue;
      if (scratch.others.size() <= kOneByOne && root(i) == most) {
        join_one_by_one(i, scratch.others, scratch.one_way);
        continue;
      }
      if (scratch.tile.size == 0) scratch.tile.gather(grid_, cell, stencil);
      join_by_tile(i, scratch);
    }
  }

  /// List the members in the cells about `cell` that are not in the set `most`.
  void list_others(const typename Grid<S>::Cell& cell, const Stencil& stencil, Index most, Indices& others) {
    const auto member = [&](std::size_t j) { return points_.member(j); };
    others.clear();
    for (const StencilRow& row : stencil) {
      const auto [begin, end] = grid_.run(cell[2] - row.outer, cell[2] + row.outer, cell[1] + row.dy, cell[0] + row.dz);
      for (auto j = static_cast<Index>(begin); j < static_cast<Index>(end); ++j)
        if (sets_.apart(j, most, member)) others.push_back(j);
    }
  }

  /// Join point i with its neighbors among `others`.
  void join_one_by_one(std::size_t i, const Indices& others, Edges& one_way) {
    const Vector3<S> p = grid_.stored_point(i);
    for (const Index o : others) {
      const auto j = static_cast<std::size_t>(o);
      const S d_sq = distance_sq<S>(grid_.stored_point(j), p);
      if (reach_.holds(i, d_sq, grid_.ids()[j])) join_smooth(i, j, d_sq, one_way);
    }
  }

  /// Join point i with its neighbors in the tile.
  void join_by_tile(std::size_t i, Scratch& scratch) {
    const Tile<S>& tile = scratch.tile;
    auto& sq = scratch.sq;
    auto& within = scratch.within;
    if (sq.size() < tile.padded()) sq.resize(2 * tile.padded()), within.resize(2 * tile.padded());
    tile.distances_sq(grid_.stored_point(i), sq.data());
    const std::size_t found = tile.list_within(sq.data(), reach_.sq[i], within.data());
    for (std::size_t f = 0; f < found; ++f) {
      const std::size_t c = within[f];
      const std::size_t j = tile.at[c];
      if (reach_.holds(i, sq[c], grid_.ids()[j])) join_smooth(i, j, sq[c], scratch.one_way);
    }
  }

  /// Join the points [begin, end) of reach_.far with their neighbors.
  void join_far(std::size_t begin, std::size_t end, std::size_t k) {
    Edges one_way;
    for (std::size_t f = begin; f < end; ++f) {
      const auto i = static_cast<std::size_t>(reach_.far[f * (k + 1)]);
      if (!points_.member(i)) continue;
      for (std::size_t at = f * (k + 1) + 1; at < (f + 1) * (k + 1) && reach_.far[at] >= 0; ++at) {
        const auto j = static_cast<std::size_t>(reach_.far[at]);
        join_smooth(i, j, distance_sq<S>(grid_.stored_point(i), grid_.stored_point(j)), one_way);
      }
    }
    add(one_way);
  }

  void add(const Edges& some) {
    if (some.empty()) return;
    const std::lock_guard<std::mutex> lock(edges_mutex_);
    edges_.insert(edges_.end(), some.begin(), some.end());
  }

  const Grid<S>& grid_;
  const OrientedPoints<S>& points_;
  const Stencil stencils_[2] = {box_stencil(1), box_stencil(2)};
  DisjointSets sets_;
  NearestReach<S> reach_;
  std::mutex edges_mutex_;
  Edges edges_;
};

/// See grow_regions; `parameters.radius` and `parameters.max_curvature` are not used. O(n k), and a sort of the edges
/// of one direction. Memory: some 50 bytes a point, 4 k for points in crowds or far from all others.
template <typename C>
Labels nearest_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                       const RegionGrowingParameters& parameters, const std::vector<scalar_t<C>>& curvatures,
                       int threads) {
  using S = scalar_t<C>;
  const std::size_t size = agrisee::size(cloud);
  const std::size_t k = std::min(static_cast<std::size_t>(parameters.neighbors), std::max<std::size_t>(size, 1));
  const NeighborhoodGrid<S> near(cloud, k, std::numeric_limits<S>::infinity(), threads);
  const Grid<S>& grid = near.grid;
  const std::size_t n = grid.stored();
  const auto& ids = grid.ids();
  const OrientedPoints<S> points(grid, normals, parameters, threads);
  const auto member = [&](std::size_t j) { return points.member(j); };
  NearestSets<S> joined(grid, points);
  joined.join(cloud, near, k, threads);
  DisjointSets& sets = joined.sets();

  Uninitialized<S> curvature(parameters.seeds_by_curvature ? n : 0);  // of the stored points
  const auto gather = [&](std::size_t j) { curvature[j] = curvatures[static_cast<std::size_t>(ids[j])]; };
  parallel_for(curvature.size(), threads, gather, 4096);
  const auto key_of = [&](std::size_t j) {
    return std::make_pair(seed_key(j, parameters.seeds_by_curvature, curvature).first, ids[j]);
  };
  const Labels regions = reached_sets(sets, n, joined.edges(), member, key_of);
  Labels labels(size, 0);
  const auto label = [&](std::size_t j) {
    if (member(j))
      labels[static_cast<std::size_t>(ids[j])] = regions[static_cast<std::size_t>(sets.root(static_cast<Index>(j)))];
  };
  parallel_for(n, threads, label, 4096);
  drop_small(labels, parameters.min_size);
  return labels;
}

}  // namespace detail

}  // namespace agrisee
