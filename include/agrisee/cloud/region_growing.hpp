// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Region growing on normals (paper, "Segmentation via Region Growing" and its algorithm): from a seed, a region takes
/// every neighbour nearer than r_v whose normal makes an angle below theta_th with the normal of the point that grows.
///
/// Any frame, metres, radians. Cost: a grid and one visit of half of each point's neighbours, O(n neighbours).
///
/// With the paper's rule the regions are the connected parts of a graph, so the order of growth does not matter.
/// Options give the rule of PCL's RegionGrowing (Rabbani et al., 2006): k nearest neighbours (a directed graph, in
/// which earlier seeds win), seeds by rising curvature, unsigned normals, and growth only from points of low curvature.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/all_neighbors.hpp>
#include <agrisee/core/components.hpp>

namespace agrisee {

namespace detail {

/// Labels of regions of at least `min_size` points, renumbered from 1 in order of creation; 0 for the rest.
inline void drop_small_regions(Labels& labels, int regions, int min_size) {
  std::vector<int> sizes(static_cast<std::size_t>(regions) + 1, 0);
  for (const int label : labels) ++sizes[static_cast<std::size_t>(label)];
  std::vector<int> renumbered(sizes.size(), 0);
  int kept = 0;
  for (std::size_t r = 1; r < sizes.size(); ++r)
    if (sizes[r] >= min_size) renumbered[r] = ++kept;
  for (int& label : labels) label = renumbered[static_cast<std::size_t>(label)];
}

/// The points in the order in which they may become seeds.
template <typename S>
Indices seed_order(std::size_t n, bool by_curvature, const std::vector<S>& curvatures) {
  Indices order(n);
  std::iota(order.begin(), order.end(), Index(0));
  if (by_curvature)
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
      return curvatures[static_cast<std::size_t>(a)] < curvatures[static_cast<std::size_t>(b)];
    });
  return order;
}

template <typename C>
void check_growing(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                   const RegionGrowingParameters& params, const std::vector<scalar_t<C>>& curvatures) {
  check_input(normals.size() == agrisee::size(cloud), "grow_regions needs one normal a point");
  check_input(!params.needs_curvature() || curvatures.size() == normals.size(),
              "grow_regions needs one curvature a point");
}

/// Whether a point can join a region at all.
template <typename S>
bool can_join(const Vector3<S>& p, const Vector3<S>& normal) {
  return is_finite(p) && is_finite(normal) && normal.squaredNorm() > 0;
}

/// Grow from seed to seed; `neighbors(i, offer)` calls offer(j) for the neighbours of point i.
template <typename C, typename Neighbors>
Labels grow_from_seeds(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                       const RegionGrowingParameters& params, const std::vector<scalar_t<C>>& curvatures,
                       Neighbors&& neighbors) {
  using S = scalar_t<C>;
  const std::size_t n = agrisee::size(cloud);
  const bool gated = params.max_curvature < 1.0 / 3.0;
  const S cos_min = static_cast<S>(std::cos(params.smoothness));

  constexpr int kFree = 0;
  constexpr int kNever = -1;
  Labels labels(n, kNever);
  for (std::size_t i = 0; i < n; ++i)
    if (can_join<S>(point(cloud, i), normals[i])) labels[i] = kFree;

  int regions = 0;
  Indices queue;
  for (const Index seed : seed_order<S>(n, params.seeds_by_curvature, curvatures)) {
    if (labels[static_cast<std::size_t>(seed)] != kFree) continue;
    labels[static_cast<std::size_t>(seed)] = ++regions;
    queue.assign(1, seed);
    for (std::size_t head = 0; head < queue.size(); ++head) {
      if ((head & 0xFF) == 0) throw_if_cancelled();
      const auto i = static_cast<std::size_t>(queue[head]);
      const Vector3<S> normal = normals[i];
      neighbors(i, [&](Index index) {
        const auto j = static_cast<std::size_t>(index);
        if (labels[j] != kFree) return;
        const S cosine = normal.dot(normals[j]);
        if (!((params.unsigned_normals ? std::abs(cosine) : cosine) > cos_min)) return;
        labels[j] = regions;
        if (!gated || static_cast<double>(curvatures[j]) <= params.max_curvature) queue.push_back(index);
      });
    }
  }
  std::replace(labels.begin(), labels.end(), kNever, 0);
  drop_small_regions(labels, regions, params.min_size);
  return labels;
}

/// The regions where all neighbours within the radius grow: the connected parts of the cloud.
template <typename C>
Labels connected_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                         const RegionGrowingParameters& params, const std::vector<scalar_t<C>>& curvatures,
                         int threads) {
  using S = scalar_t<C>;
  const std::size_t n = agrisee::size(cloud);
  const S radius = static_cast<S>(params.radius), radius_sq = radius * radius;
  const S cos_min = static_cast<S>(std::cos(params.smoothness));
  const Grid<S> grid(cloud, S(1.00001) * radius, threads);
  const auto id = [&](std::size_t j) { return static_cast<std::size_t>(grid.ids()[j]); };
  std::vector<S> nx(grid.stored()), ny(grid.stored()), nz(grid.stored());
  const auto gather = [&](std::size_t j) {
    Vector3<S> normal = normals[id(j)];
    if (!can_join<S>(grid.stored_point(j), normal)) normal.setConstant(std::numeric_limits<S>::quiet_NaN());
    nx[j] = normal.x(), ny[j] = normal.y(), nz[j] = normal.z();
  };
  parallel_for(grid.stored(), threads, gather, 4096);
  const S *x = grid.x().data(), *y = grid.y().data(), *z = grid.z().data();
  const S *u = nx.data(), *v = ny.data(), *w = nz.data();
  const auto join = [&](DisjointSets& sets, const auto& cosine) {
    join_neighbors(
        grid, box_stencil(1), threads, sets, [&](std::size_t j) { return !std::isnan(u[j]); },
        [&](std::size_t j, std::size_t begin, std::size_t end, std::uint8_t* is) {
          const S qx = x[j], qy = y[j], qz = z[j], qu = u[j], qv = v[j], qw = w[j];
          for (std::size_t i = begin; i < end; ++i) {
            const S dx = x[i] - qx, dy = y[i] - qy, dz = z[i] - qz;
            const bool near = dx * dx + dy * dy + dz * dz < radius_sq;
            const bool smooth = cosine(u[i] * qu + (v[i] * qv + w[i] * qw)) > cos_min;
            is[i - begin] = static_cast<std::uint8_t>(near & smooth);
          }
        });
  };
  DisjointSets sets(grid.stored());
  if (params.unsigned_normals)
    join(sets, [](S c) { return std::abs(c); });
  else
    join(sets, [](S c) { return c; });

  std::vector<Index> ranks;  // of the seeds, where these are not in the cloud's order
  if (params.seeds_by_curvature) {
    ranks.resize(n);
    const Indices order = seed_order<S>(n, true, curvatures);
    for (std::size_t r = 0; r < n; ++r) ranks[static_cast<std::size_t>(order[r])] = static_cast<Index>(r);
  }
  const Labels stored = number_sets(
      sets, grid.stored(), static_cast<std::size_t>(params.min_size), threads,
      [&](std::size_t j) { return !std::isnan(nx[j]); },
      [&](std::size_t j) { return ranks.empty() ? grid.ids()[j] : ranks[id(j)]; });
  Labels labels(n, 0);
  parallel_for(grid.stored(), threads, [&](std::size_t j) { labels[id(j)] = stored[j]; }, 4096);
  return labels;
}

}  // namespace detail

/// One label per point: regions from 1 in order of creation, 0 = residual. The cloud is not changed.
///
/// Points that are not finite, or whose normal is zero or not finite, never join.
/// @param cloud points (m), any cloud type
/// @param normals one unit normal a point, all turned to the same side unless `unsigned_normals`
/// @param params see their struct
/// @param search a KdTree or Grid over `cloud`
/// @param curvatures one finite surface variation a point where the parameters ask for it (estimate_normals gives them)
/// @throws ParameterError for a bad parameter, InputError when sizes disagree or curvatures are missing
template <typename C, typename Search>
Labels grow_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                    const RegionGrowingParameters& params, const Search& search,
                    const std::vector<scalar_t<C>>& curvatures = {}) {
  using S = scalar_t<C>;
  params.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(search.size() == n, "the search and the cloud differ in size");
  detail::check_growing(cloud, normals, params, curvatures);
  const S radius = static_cast<S>(params.radius), radius_sq = radius * radius;
  Neighbors<S> found;
  return detail::grow_from_seeds(cloud, normals, params, curvatures, [&](std::size_t i, auto&& offer) {
    if (params.neighbors > 0) {
      search.knn(point(cloud, i), static_cast<std::size_t>(params.neighbors), found);
      for (const auto& neighbor : found) offer(neighbor.index);
    } else {
      search.visit(point(cloud, i), radius, [&](Index index, S d_sq) {
        if (d_sq < radius_sq) offer(index);
      });
    }
  });
}

/// The same with neighbour lists that are there already; their k stands for `params.neighbors`.
template <typename C>
Labels grow_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                    const RegionGrowingParameters& params, const NeighborLists& lists,
                    const std::vector<scalar_t<C>>& curvatures = {}) {
  params.check();
  check_input(lists.size() == agrisee::size(cloud), "the neighbour lists and the cloud differ in size");
  detail::check_growing(cloud, normals, params, curvatures);
  return detail::grow_from_seeds(cloud, normals, params, curvatures,
                                 [&](std::size_t i, auto&& offer) { lists.visit(i, offer); });
}

/// The same without a search; several times as fast.
template <typename C>
Labels grow_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                    const RegionGrowingParameters& params = {}, const std::vector<scalar_t<C>>& curvatures = {},
                    int threads = 1) {
  params.check();
  detail::check_growing(cloud, normals, params, curvatures);
  if (params.neighbors > 0)
    return grow_regions(cloud, normals, params,
                        nearest_neighbors(cloud, static_cast<std::size_t>(params.neighbors), threads), curvatures);
  if (params.max_curvature < 1.0 / 3.0)  // not all grow: the order matters
    return grow_regions(cloud, normals, params, Grid<scalar_t<C>>(cloud, static_cast<scalar_t<C>>(params.radius)),
                        curvatures);
  return detail::connected_regions(cloud, normals, params, curvatures, threads);
}

/// Indices of the points without a label (0), ascending: the paper's set U, to which DBSCAN is applied.
inline Indices residual(const Labels& labels) {
  Indices out;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] == 0) out.push_back(static_cast<Index>(i));
  return out;
}

}  // namespace agrisee
