// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Counts the points within a radius of each point of a cloud, for all points at once. Cells that lie wholly within the
/// radius are counted without testing their points.
///
/// Any frame; metres. Cost: building a grid, and testing the points of the cells that the spheres cut. With 1,500
/// neighbors per point that is about a quarter of all pairs within the radius; with 50 it is three times these pairs.
#pragma once

#include <agrisee/neighbors/detail/tiles.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace agrisee {

namespace detail {

/// Estimates the mean number of points within r (m), from 32 points and a subset of their neighbors.
template <typename C>
double typical_count(const C& cloud, scalar_t<C> r) {
  using S = scalar_t<C>;
  const std::size_t n = agrisee::size(cloud), stride = std::max<std::size_t>(1, n / 4096);
  constexpr std::size_t kSamples = 32;
  std::size_t in = 0;
  for (std::size_t s = 0; s < kSamples && n > 0; ++s) {
    const Vector3<S> q = point(cloud, s * n / kSamples);
    for (std::size_t i = 0; i < n; i += stride) in += distance_sq<S>(point(cloud, i), q) <= r * r ? 1u : 0u;
  }
  return static_cast<double>(in * stride) / static_cast<double>(kSamples);
}

/// The number of cells per radius that makes counting fast: such that a cell holds about ten points.
template <typename C>
int cells_per_radius(const C& cloud, scalar_t<C> r) {
  return std::clamp(static_cast<int>(std::sqrt(typical_count(cloud, r) / 50.0)), 1, 6);
}

/// Number of points of a tile with a squared distance to q of at most r_sq (m2).
template <typename S>
std::size_t count_within(const Tile<S>& tile, const Vector3<S>& q, S r_sq) {
  return tile.inside + tile.count_within(distance_sq_from(q, tile.x.data(), tile.y.data(), tile.z.data()), r_sq);
}

}  // namespace detail

/// A grid that suits counting within a radius, and the cells to search around each cell.
template <typename S>
struct CountingGrid {
  /// @param cloud points (m), any cloud type
  /// @param r radius within which to count (m)
  /// @param threads the result does not depend on it
  template <typename C>
  CountingGrid(const C& cloud, S r, int threads = 1)
      : radius(r),
        grid(cloud,
             S(1.00001) * std::max(r, std::numeric_limits<S>::min()) /
                 static_cast<S>(detail::cells_per_radius(cloud, r)),
             threads),
        stencil(detail::ball_stencil(double(r) / grid.cell())) {}

  S radius;                 ///< m
  Grid<S> grid;             ///< the points of the cloud
  detail::Stencil stencil;  ///< the cells within reach of a cell

  /// Calls f(j, count) for every stored point j: the number of points at most `radius` from it, including itself.
  template <typename F>
  void count(int threads, const F& f) const {
    detail::for_cells(grid, threads, [&] {
      return [&, tile = detail::Tile<S>()](const detail::GridCell& cell, std::size_t begin, std::size_t end) mutable {
        tile.gather(grid, cell, stencil);
        for (std::size_t j = begin; j < end; ++j)
          f(j, detail::count_within(tile, grid.stored_point(j), radius * radius));
      };
    });
  }
};

/// Number of points at most `r` (m) from each point of a cloud, including itself; 0 for points that are not finite.
/// @throws ParameterError if r is negative or not finite
template <typename C>
std::vector<int> count_neighbors(const C& cloud, scalar_t<C> r, int threads = 1) {
  check_parameter(std::isfinite(r) && r >= 0, "radius", "not negative and finite", r);
  std::vector<int> counts(agrisee::size(cloud), 0);
  const CountingGrid<scalar_t<C>> counting(cloud, r, threads);
  counting.count(threads,
                 [&](std::size_t j, std::size_t in) { at(counts, counting.grid.ids()[j]) = static_cast<int>(in); });
  return counts;
}

}  // namespace agrisee
