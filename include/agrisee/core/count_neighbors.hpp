// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How many points lie within a radius of each point of a cloud, all points at once: cells that lie wholly within the
/// radius are counted without a look at their points.
///
/// Any frame, metres. Cost: a grid and the distance tests of the cells that the spheres cut; about a quarter of all
/// pairs within the radius at 1,500 neighbours, three times these pairs at 50.
#pragma once

#include <agrisee/core/sums.hpp>
#include <agrisee/core/tiles.hpp>

#include <algorithm>

namespace agrisee {

namespace detail {

/// Mean number of points within r of a few points of the cloud, judged by a share of the points.
template <typename C>
double typical_count(const C& cloud, scalar_t<C> r) {
  using S = scalar_t<C>;
  const std::size_t n = agrisee::size(cloud), share = std::max<std::size_t>(1, n / 4096);
  constexpr std::size_t kSamples = 32;
  std::size_t in = 0;
  for (std::size_t s = 0; s < kSamples && n > 0; ++s) {
    const Vector3<S> q = point(cloud, s * n / kSamples);
    for (std::size_t i = 0; i < n; i += share) in += distance_sq<S>(point(cloud, i), q) <= r * r ? 1u : 0u;
  }
  return static_cast<double>(in * share) / static_cast<double>(kSamples);
}

/// Cells a radius that make counting fast: each should hold some ten points.
template <typename C>
int cells_a_radius(const C& cloud, scalar_t<C> r) {
  return std::clamp(static_cast<int>(std::sqrt(typical_count(cloud, r) / 50.0)), 1, 6);
}

/// Points of the tile within r_sq of q.
template <typename S>
std::size_t count_within(const Tile<S>& tile, const Vector3<S>& q, S r_sq) {
  const S qx = q.x(), qy = q.y(), qz = q.z(), *x = tile.x.data(), *y = tile.y.data(), *z = tile.z.data();
  const auto distance_sq = [=](std::size_t j) {
    const S dx = x[j] - qx, dy = y[j] - qy, dz = z[j] - qz;
    return detail::sum_of_squares(dx, dy, dz);
  };
  return tile.inside + tile.count_within(distance_sq, r_sq);
}

}  // namespace detail

/// A grid that serves for counting within `r` (m), and the cells about a cell that matter.
template <typename S>
struct CountingGrid {
  /// Of a cloud, to count within r (m). It does not depend on `threads`.
  template <typename C>
  CountingGrid(const C& cloud, S r, int threads = 1)
      : radius(r),
        grid(cloud,
             S(1.00001) * std::max(r, std::numeric_limits<S>::min()) / static_cast<S>(detail::cells_a_radius(cloud, r)),
             threads),
        stencil(ball_stencil(double(r) / grid.cell())) {}

  S radius;         ///< m
  Grid<S> grid;     ///< of the cloud
  Stencil stencil;  ///< the cells within reach

  /// f(j, count) for every stored point j: the points at most `radius` from it, itself included.
  template <typename F>
  void count(int threads, const F& f) const {
    for_cells(grid, threads, [&] {
      return [&, tile = Tile<S>()](const typename Grid<S>::Cell& cell, std::size_t begin, std::size_t end) mutable {
        tile.gather(grid, cell, stencil);
        for (std::size_t j = begin; j < end; ++j)
          f(j, detail::count_within(tile, grid.stored_point(j), radius * radius));
      };
    });
  }
};

/// Points at most `r` (m) from each point of a cloud, itself included; 0 for points that are not finite.
/// @throws ParameterError when r is negative or not finite
template <typename C>
std::vector<int> count_neighbors(const C& cloud, scalar_t<C> r, int threads = 1) {
  check_parameter(std::isfinite(r) && r >= 0, "radius", "not negative and finite", r);
  std::vector<int> counts(agrisee::size(cloud), 0);
  const CountingGrid<scalar_t<C>> counting(cloud, r, threads);
  counting.count(threads, [&](std::size_t j, std::size_t in) {
    counts[static_cast<std::size_t>(counting.grid.ids()[j])] = static_cast<int>(in);
  });
  return counts;
}

}  // namespace agrisee
