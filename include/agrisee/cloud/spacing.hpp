// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a cloud says of itself: how far apart its points are, and how noisy. Parameters are derived from it instead of
/// fixed millimetres.
#pragma once

#include <agrisee/core/grid.hpp>
#include <agrisee/core/typical_distance.hpp>
#include <agrisee/geometry/pca.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee {

/// Typical distance (m) between neighbouring points: the square root of the area that a point stands for on a locally
/// flat surface, from the median distance to the 8th neighbour (pi d8^2 holds 9 points). 0 for fewer than two distinct
/// points. At most `samples` points are asked, evenly spread in index order.
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
    while (!found.empty() && !std::isfinite(found.back().distance)) found.pop_back();  // too far for S to tell how far
    if (found.size() < 2) continue;
    spacing.push_back(double(found.back().distance) * std::sqrt(kPi / double(found.size())));
  }
  if (spacing.empty()) return 0.0;
  const auto mid = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), mid, spacing.end());
  return *mid;
}

/// The same with a search made for the purpose.
template <typename C>
double estimate_spacing(const C& cloud) {
  using S = scalar_t<C>;
  return estimate_spacing(cloud, Grid<S>(cloud, detail::typical_distance(cloud, 9)));
}

/// Standard deviation (m) of the points about the surface they lie on: the median over points of the deviation from a
/// plane through all points within `radius` (m), less that of a sphere of radius `curvature` (m) from its tangent plane
/// (seen over a disc, radius^2 / (2 sqrt(12) curvature)). Errors that neighbours share are not seen. 0 when no point
/// has seven others within `radius`. At most `samples` points are asked, evenly spread in index order.
template <typename C, typename Search>
double estimate_noise(const C& cloud, const Search& search, double radius, double curvature,
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
    const auto count = static_cast<double>(found.size());  // a plane takes three of the points' freedoms
    const double variance = principal_axes<double>(moments.mean(), moments.covariance()).variance[0];
    deviations.push_back(std::max(variance, 0.0) * count / (count - 3.0));
  }
  if (deviations.empty()) return 0.0;
  const auto mid = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
  std::nth_element(deviations.begin(), mid, deviations.end());
  const double bend = radius * radius / (2.0 * std::sqrt(12.0) * curvature);
  return std::sqrt(std::max(0.0, *mid - bend * bend));
}

}  // namespace agrisee
