// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Region growing on normals ([1], 2.2.3, eq. 10 to 13): a region starts from a seed
/// and takes every neighbor that is nearer than r_v and whose normal makes an angle below theta_th with the normal of
/// the point that grows.
///
/// Any frame; metres, radians. Cost: a grid and one or two visits of each point's neighbors, O(n neighbors).
///
/// With the rule of [1] the regions are the connected parts of a graph, so the order of growth does not matter.
/// Options give the rule of PCL's RegionGrowing (Rabbani et al., 2006): the k nearest neighbors (a directed graph, in
/// which earlier seeds win), seeds by rising curvature, normals without sign, and growth only from points of low
/// curvature.
#pragma once

#include <agrisee/cloud/connected_regions.hpp>
#include <agrisee/cloud/labels.hpp>
#include <agrisee/cloud/nearest_regions.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

namespace agrisee {

namespace detail {

/// Grow one region after another, each from its seed.
/// @param neighbors neighbors(i, offer) calls offer(j) for the neighbors j of point i
template <typename C, typename Neighbors>
Labels grow_from_seeds(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                       const RegionGrowingParameters& parameters, const std::vector<scalar_t<C>>& curvatures,
                       Neighbors&& neighbors) {
  using S = scalar_t<C>;
  const std::size_t n = agrisee::size(cloud);
  const bool gated = parameters.max_curvature < 1.0 / 3.0;
  const S cos_min = static_cast<S>(std::cos(parameters.smoothness));

  constexpr int kFree = 0;
  constexpr int kNever = -1;
  Labels labels(n, kNever);
  for (std::size_t i = 0; i < n; ++i)
    if (can_join<S>(point(cloud, i), normals[i])) labels[i] = kFree;

  int regions = 0;
  Indices queue;
  for (const Index seed : seed_order<S>(n, parameters.seeds_by_curvature, curvatures)) {
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
        if (!(cosine(normal.x(), normal.y(), normal.z(), other.x(), other.y(), other.z(), parameters.unsigned_normals) >
              cos_min))
          return;
        labels[j] = regions;
        if (!gated || static_cast<double>(curvatures[j]) <= parameters.max_curvature) queue.push_back(index);
      });
    }
  }
  std::replace(labels.begin(), labels.end(), kNever, 0);
  drop_small(labels, parameters.min_size);
  return labels;
}

}  // namespace detail

/// Grow regions, looking up neighbors in a search that exists already.
///
/// Points that are not finite, or whose normal is zero or not finite, never join a region.
/// @param cloud points (m), any cloud type
/// @param normals one unit normal per point, all turned to the same side unless `unsigned_normals`
/// @param parameters see their struct
/// @param search a KdTree or Grid over `cloud`
/// @param curvatures one surface variation per point, if `parameters` ask for it (estimate_normals gives them)
/// @return one label per point: regions from 1 in the order of their seeds, 0 for points of no region (the residual)
/// @throws ParameterError for a bad parameter, InputError if sizes disagree or curvatures are missing
template <typename C, typename Search>
Labels grow_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                    const RegionGrowingParameters& parameters, const Search& search,
                    const std::vector<scalar_t<C>>& curvatures = {}) {
  using S = scalar_t<C>;
  parameters.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(search.size() == n, "the search and the cloud differ in size");
  detail::check_growing(cloud, normals, parameters, curvatures);
  const S radius = static_cast<S>(parameters.radius), radius_sq = radius * radius;
  Neighbors<S> found;
  return detail::grow_from_seeds(cloud, normals, parameters, curvatures, [&](std::size_t i, auto&& offer) {
    if (parameters.neighbors > 0) {
      search.knn(point(cloud, i), static_cast<std::size_t>(parameters.neighbors), found);
      for (const auto& neighbor : found) offer(neighbor.index);
    } else {
      search.visit(point(cloud, i), radius, [&](Index index, S d_sq) {
        if (d_sq < radius_sq) offer(index);
      });
    }
  });
}

/// Grow regions over neighbor lists that exist already; their k replaces `parameters.neighbors`.
template <typename C>
Labels grow_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                    const RegionGrowingParameters& parameters, const NeighborLists& lists,
                    const std::vector<scalar_t<C>>& curvatures = {}) {
  parameters.check();
  check_input(lists.size() == agrisee::size(cloud), "the neighbor lists and the cloud differ in size");
  detail::check_growing(cloud, normals, parameters, curvatures);
  return detail::grow_from_seeds(cloud, normals, parameters, curvatures,
                                 [&](std::size_t i, auto&& offer) { lists.visit(i, offer); });
}

/// Grow regions without a ready-made search; several times as fast as with one, and with the same result.
/// @param threads the result does not depend on it
template <typename C>
Labels grow_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                    const RegionGrowingParameters& parameters = {}, const std::vector<scalar_t<C>>& curvatures = {},
                    int threads = 1) {
  parameters.check();
  detail::check_growing(cloud, normals, parameters, curvatures);
  const bool all_grow = parameters.max_curvature >= 1.0 / 3.0;
  if (all_grow && parameters.neighbors > 0)
    return detail::nearest_regions(cloud, normals, parameters, curvatures, threads);
  if (all_grow) return detail::connected_regions(cloud, normals, parameters, curvatures, threads);
  if (parameters.neighbors > 0)  // some points do not grow: the order matters
    return grow_regions(cloud, normals, parameters,
                        nearest_neighbors(cloud, static_cast<std::size_t>(parameters.neighbors), threads), curvatures);
  return grow_regions(cloud, normals, parameters, Grid<scalar_t<C>>(cloud, static_cast<scalar_t<C>>(parameters.radius)),
                      curvatures);
}

}  // namespace agrisee
