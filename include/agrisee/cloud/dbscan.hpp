// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// DBSCAN (Ester et al., KDD 1996; [1], 2.2.4, eq. 14 and 15): clusters of points with many neighbors.
///
/// Any frame, metres. Cost O(n neighbors): a grid, a count for each point and a visit of half of each core point's
/// neighbors, no lists. The time goes into distance tests, about three per neighbor. Core points are joined by
/// union-find, which gives the textbook algorithm's answer.
///
/// A neighbor is a point at distance <= eps, as KdTree and Grid search (Open3D, PCL and grow_regions take smaller
/// distances only, which differs only for distances of exactly eps). The point itself counts, as in Open3D.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/detail/sums.hpp>
#include <agrisee/neighbors/components.hpp>
#include <agrisee/neighbors/count_neighbors.hpp>

namespace agrisee {

namespace detail {

/// Label the core points: clusters are numbered from 1 in the order of their first core points; other points get 0.
/// @param core whether a point is a core point
/// @param roots a number for each point, equal for core points of one cluster
inline Labels number_clusters(const std::vector<char>& core, const std::vector<Index>& roots) {
  Labels labels(core.size(), 0), number(core.size(), 0);
  int clusters = 0;
  for (std::size_t i = 0; i < core.size(); ++i) {
    if (!core[i]) continue;
    int& mine = number[static_cast<std::size_t>(roots[i])];
    if (mine == 0) mine = ++clusters;
    labels[i] = mine;
  }
  return labels;
}

/// Give each stored point without a label the least label of the core points within the radius, if there are any.
/// @param counting the cloud's grid, its radius being eps
/// @param stored_labels of the stored points; only core points have any
/// @param labels receives the labels, one per point of the cloud
template <typename S>
void label_border(const CountingGrid<S>& counting, const Labels& stored_labels, int threads, Labels& labels) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  const Grid<S>& grid = counting.grid;
  const S *x = grid.x().data(), *y = grid.y().data(), *z = grid.z().data();
  const S eps_sq = counting.radius * counting.radius;
  for_cells(grid, threads, [&] {
    return [&](const typename Grid<S>::Cell& cell, std::size_t first, std::size_t last) {
      for (std::size_t j = first; j < last; ++j) {
        if (stored_labels[j] != 0) continue;
        const S qx = x[j], qy = y[j], qz = z[j];
        auto least = kNone;
        for (const StencilRow& row : counting.stencil) {
          const auto [begin, end] =
              grid.run(cell[2] - row.outer, cell[2] + row.outer, cell[1] + row.dy, cell[0] + row.dz);
          for (std::size_t i = begin; i < end; ++i) {
            const S dx = x[i] - qx, dy = y[i] - qy, dz = z[i] - qz;
            const auto its = static_cast<std::uint32_t>(stored_labels[i]) - 1u;  // without a label: the largest number
            least = std::min(least, sum_of_squares(dx, dy, dz) <= eps_sq ? its : kNone);
          }
        }
        if (least != kNone) labels[static_cast<std::size_t>(grid.ids()[j])] = static_cast<int>(least) + 1;
      }
    };
  });
}

}  // namespace detail

/// Find clusters. A border point belongs to the first cluster that has a core point within eps of it. Points that are
/// not finite are noise.
/// @param cloud points (m), any cloud type
/// @param parameters see their struct
/// @param search a KdTree or Grid over `cloud`
/// @param threads the result does not depend on it
/// @return one label per point: clusters from 1 in the order of their first core points, 0 = noise
/// @throws ParameterError for a bad parameter, InputError if the search is over a cloud of another size
template <typename C, typename Search>
Labels dbscan(const C& cloud, const DbscanParameters& parameters, const Search& search, int threads = 1) {
  using S = scalar_t<C>;
  parameters.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(search.size() == n, "the search and the cloud differ in size");
  const S eps = static_cast<S>(parameters.eps);
  const auto needed = static_cast<std::size_t>(parameters.min_points);

  std::vector<char> core(n, 0);
  parallel_for(n, threads, [&](std::size_t i) { core[i] = search.count(point(cloud, i), eps, needed) >= needed; });

  DisjointSets sets(n);
  parallel_for(n, threads, [&](std::size_t i) {
    if (!core[i]) return;
    const auto self = static_cast<Index>(i);
    search.visit(point(cloud, i), eps, [&](Index j, S) {
      if (j < self && core[static_cast<std::size_t>(j)]) sets.join(self, j);
    });
  });
  std::vector<Index> roots(n);
  for (std::size_t i = 0; i < n; ++i) roots[i] = sets.root(static_cast<Index>(i));
  Labels labels = detail::number_clusters(core, roots);
  parallel_for(n, threads, [&](std::size_t i) {
    if (core[i]) return;
    int first = 0;
    search.visit(point(cloud, i), eps, [&](Index j, S) {
      const auto k = static_cast<std::size_t>(j);
      if (core[k] && (first == 0 || labels[k] < first)) first = labels[k];
    });
    labels[i] = first;
  });
  return labels;
}

/// dbscan without a ready-made search; several times as fast.
template <typename C>
Labels dbscan(const C& cloud, const DbscanParameters& parameters = {}, int threads = 1) {
  using S = scalar_t<C>;
  parameters.check();
  const S eps = static_cast<S>(parameters.eps), eps_sq = eps * eps;
  const auto needed = static_cast<std::size_t>(parameters.min_points);
  const CountingGrid<S> counting(cloud, eps, threads);
  const Grid<S>& grid = counting.grid;
  const S *x = grid.x().data(), *y = grid.y().data(), *z = grid.z().data();

  std::vector<std::uint8_t> stored_core(grid.stored());
  counting.count(threads, [&](std::size_t j, std::size_t in) { stored_core[j] = in >= needed; });

  DisjointSets sets(grid.stored());
  join_neighbors(
      grid, counting.stencil, threads, sets, [&](std::size_t j) { return stored_core[j] != 0; },
      [&](std::size_t j, std::size_t begin, std::size_t end, std::uint8_t* is) {
        const S qx = x[j], qy = y[j], qz = z[j];
        for (std::size_t i = begin; i < end; ++i) {
          const S dx = x[i] - qx, dy = y[i] - qy, dz = z[i] - qz;
          const bool near = detail::sum_of_squares(dx, dy, dz) <= eps_sq;
          is[i - begin] = static_cast<std::uint8_t>(near & stored_core[i]);
        }
      });

  // Clusters are numbered by their first core point in the cloud's order.
  const Labels stored_labels = number_sets(
      sets, grid.stored(), 1, threads, [&](std::size_t j) { return stored_core[j] != 0; },
      [&](std::size_t j) { return grid.ids()[j]; });
  Labels labels(agrisee::size(cloud), 0);
  const auto label = [&](std::size_t j) { labels[static_cast<std::size_t>(grid.ids()[j])] = stored_labels[j]; };
  parallel_for(grid.stored(), threads, label, 4096);
  detail::label_border(counting, stored_labels, threads, labels);
  return labels;
}

}  // namespace agrisee
