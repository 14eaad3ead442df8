// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Estimates from a cloud how far apart its points are and how noisy they are, so that parameters can be derived from
/// the cloud instead of being fixed lengths.
#pragma once

#include <agrisee/core/median.hpp>
#include <agrisee/geometry/pca.hpp>
#include <agrisee/neighbors/detail/typical_distance.hpp>
#include <agrisee/neighbors/grid.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee {

/// Typical distance (m) between neighboring points: the square root of the area per point on a locally flat surface. It
/// follows from the median distance d8 of the 8th neighbor, as a disc of area pi d8^2 holds 9 points. 0 for fewer than
/// two distinct points.
/// @param cloud points (m), any cloud type
/// @param search a KdTree or Grid over `cloud`
/// @param samples about this many points are looked at (at most twice as many), evenly spread in index order
template <typename C, typename Search>
double estimate_spacing(const C& cloud, const Search& search, std::size_t samples = 1000) {
  using S = scalar_t<C>;
  const std::size_t n = agrisee::size(cloud);
  if (n < 2) return 0.0;
  std::vector<double> spacing;
  Neighbors<S> found;
  const std::size_t step = std::max<std::size_t>(1, n / samples);
  for (std::size_t i = 0; i < n; i += step) {
    const Vector3<S> p = point(cloud, i);
    if (!is_finite(p)) continue;
    throw_if_cancelled();
    search.knn(p, 9, found);
    while (!found.empty() && !std::isfinite(found.back().distance)) found.pop_back();  // too far away for S
    if (found.size() < 2) continue;
    spacing.push_back(double(found.back().distance) * std::sqrt(kPi / double(found.size())));
  }
  return median(spacing);
}

/// estimate_spacing with a search built for the call.
template <typename C>
double estimate_spacing(const C& cloud) {
  using S = scalar_t<C>;
  return estimate_spacing(cloud, Grid<S>(cloud, detail::typical_distance(cloud, 9)));
}

/// Standard deviation (m) of the points about the surface they lie on: the median over points of the deviation from a
/// plane fitted to all points within `radius`, less the part that is due to the surface's curvature. For a sphere of
/// radius R that part is radius^2 / (2 sqrt(12) R), the deviation from the tangent plane over a disc. Errors that
/// neighboring points share are not seen. 0 if no point has seven others within `radius`.
/// @param cloud points (m), any cloud type
/// @param search a KdTree or Grid over `cloud`
/// @param radius of the neighborhoods (m)
/// @param surface_radius the surface's radius of curvature R (m)
/// @param samples about this many points are looked at (at most twice as many), evenly spread in index order
template <typename C, typename Search>
double estimate_noise(const C& cloud, const Search& search, double radius, double surface_radius,
                      std::size_t samples = 1000) {
  using S = scalar_t<C>;
  const std::size_t n = agrisee::size(cloud), step = std::max<std::size_t>(1, n / samples);
  std::vector<double> deviations;
  Neighbors<S> found;
  Moments moments;
  for (std::size_t i = 0; i < n; i += step) {
    const Vector3<S> p = point(cloud, i);
    if (!is_finite(p)) continue;
    throw_if_cancelled();
    search.radius(p, static_cast<S>(radius), found);
    if (found.size() < 8) continue;
    moments.reset(p.template cast<double>());
    for (const auto& neighbor : found)
      moments.add(point(cloud, static_cast<std::size_t>(neighbor.index)).template cast<double>());
    const auto count = static_cast<double>(found.size());  // a plane takes three degrees of freedom
    const double variance = principal_axes<double>(moments.mean(), moments.covariance()).variance[0];
    deviations.push_back(std::max(variance, 0.0) * count / (count - 3.0));
  }
  if (deviations.empty()) return 0.0;
  const double bend = radius * radius / (2.0 * std::sqrt(12.0) * surface_radius);
  return std::sqrt(std::max(0.0, median(deviations) - bend * bend));
}

}  // namespace agrisee
