// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Region growing on normals (paper, "Segmentation via Region Growing" and its algorithm): from a seed, a region takes
/// every neighbour nearer than r_v whose normal makes an angle below theta_th with the normal of the point that grows.
///
/// Any frame, metres, radians. Cost: a grid and a visit or two of each point's neighbours, O(n neighbours).
///
/// With the paper's rule the regions are the connected parts of a graph, so the order of growth does not matter.
/// Options give the rule of PCL's RegionGrowing (Rabbani et al., 2006): k nearest neighbours (a directed graph, in
/// which earlier seeds win), seeds by rising curvature, unsigned normals, and growth only from points of low curvature.
#pragma once

#include <agrisee/cloud/connected_regions.hpp>
#include <agrisee/cloud/nearest_regions.hpp>
#include <agrisee/core/neighbor_lists.hpp>

namespace agrisee {

namespace detail {

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
        const Vector3<S>& other = normals[j];
        if (!(cosine(normal.x(), normal.y(), normal.z(), other.x(), other.y(), other.z(), params.unsigned_normals) >
              cos_min))
          return;
        labels[j] = regions;
        if (!gated || static_cast<double>(curvatures[j]) <= params.max_curvature) queue.push_back(index);
      });
    }
  }
  std::replace(labels.begin(), labels.end(), kNever, 0);
  drop_small_regions(labels, regions, params.min_size);
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
  const bool all_grow = params.max_curvature >= 1.0 / 3.0;
  if (all_grow && params.neighbors > 0) return detail::nearest_regions(cloud, normals, params, curvatures, threads);
  if (all_grow) return detail::connected_regions(cloud, normals, params, curvatures, threads);
  if (params.neighbors > 0)  // the order matters
    return grow_regions(cloud, normals, params,
                        nearest_neighbors(cloud, static_cast<std::size_t>(params.neighbors), threads), curvatures);
  return grow_regions(cloud, normals, params, Grid<scalar_t<C>>(cloud, static_cast<scalar_t<C>>(params.radius)),
                      curvatures);
}

/// Indices of the points without a label (0), ascending: the paper's set U, to which DBSCAN is applied.
inline Indices residual(const Labels& labels) {
  Indices out;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] == 0) out.push_back(static_cast<Index>(i));
  return out;
}

}  // namespace agrisee
