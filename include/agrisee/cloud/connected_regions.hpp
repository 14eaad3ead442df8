// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Region growing if every point grows and the neighbors of a point are those within a radius. Regions are then the
/// connected parts of a graph; they are joined by union-find on all threads.
#pragma once

#include <agrisee/cloud/region_rules.hpp>
#include <agrisee/neighbors/components.hpp>

namespace agrisee {

namespace detail {

/// See grow_regions; `parameters.neighbors` and `parameters.max_curvature` are not used.
template <typename C>
Labels connected_regions(const C& cloud, const std::vector<Vector3<scalar_t<C>>>& normals,
                         const RegionGrowingParameters& parameters, const std::vector<scalar_t<C>>& curvatures,
                         int threads) {
  using S = scalar_t<C>;
  const std::size_t n = agrisee::size(cloud);
  const S radius = static_cast<S>(parameters.radius);
  const Grid<S> grid(cloud, S(1.00001) * radius, threads);
  const OrientedPoints<S> points(grid, normals, parameters, threads);
  const auto id = [&](std::size_t j) { return static_cast<std::size_t>(grid.ids()[j]); };
  const auto member = [&](std::size_t j) { return points.member(j); };
  DisjointSets sets(grid.stored());
  join_neighbors(grid, box_stencil(1), threads, sets, member,
                 [&](std::size_t j, std::size_t begin, std::size_t end, std::uint8_t* is) {
                   points.smooth_within(j, radius * radius, begin, end, is);
                 });
  const std::vector<Index> ranks = seed_ranks<S>(n, parameters.seeds_by_curvature, curvatures);
  const Labels numbers =
      number_sets(sets, grid.stored(), static_cast<std::size_t>(parameters.min_size), threads, member,
                  [&](std::size_t j) { return ranks.empty() ? grid.ids()[j] : ranks[id(j)]; });
  Labels labels(n, 0);
  parallel_for(
      grid.stored(), threads, [&](std::size_t j) { labels[id(j)] = numbers[j]; }, 4096);
  return labels;
}

}  // namespace detail

}  // namespace agrisee
