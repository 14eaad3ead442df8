// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Estimates how far apart the points of a cloud are from a small sample. Grids choose their cell size by it, and
/// searches their first radius.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/median.hpp>
#include <agrisee/core/parallel.hpp>
#include <agrisee/neighbors/neighbors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace agrisee::detail {

/// The squared distance (m2) of rank `rank`, from 0, among those from q to all points; the largest if there are fewer
/// points. A single pass that keeps the smallest values so far, sorted; few points change them.
template <typename S>
S nth_distance_sq(const std::vector<Vector3<S>>& points, const Vector3<S>& q, std::size_t rank) {
  constexpr std::size_t kBlock = 64;
  std::vector<S> least(std::min(rank + 1, points.size()), std::numeric_limits<S>::infinity());  // sorted
  S block[kBlock];
  for (std::size_t begin = 0; begin < points.size(); begin += kBlock) {
    const std::size_t size = std::min(kBlock, points.size() - begin);
    S nearest = std::numeric_limits<S>::infinity();
    for (std::size_t i = 0; i < size; ++i) {
      block[i] = distance_sq<S>(points[begin + i], q);
      nearest = std::min(nearest, block[i]);
    }
    if (!(nearest < least.back())) continue;
    for (std::size_t i = 0; i < size; ++i) {
      if (!(block[i] < least.back())) continue;
      const auto at = std::upper_bound(least.begin(), least.end(), block[i]);
      std::move_backward(at, least.end() - 1, least.end());
      *at = block[i];
    }
  }
  return least.back();
}

/// Estimates the median distance (m) from a point to its k-th nearest neighbor, from 16 points of the cloud and, for
/// large k, a subset of their neighbors. Points whose k-th neighbor coincides with them are left out. Returns 1 if no
/// points are left. O(n).
template <typename C>
scalar_t<C> typical_distance(const C& cloud, std::size_t k, int threads = 1) {
  using S = scalar_t<C>;
  constexpr std::size_t kSamples = 16;
  const std::size_t n = agrisee::size(cloud), stride = std::max<std::size_t>(1, k / 4);
  std::vector<Vector3<S>> subset;
  subset.reserve(n / stride + 1);
  for (std::size_t i = 0; i < n; i += stride)
    if (is_finite(point(cloud, i))) subset.push_back(point(cloud, i));
  std::vector<S> found(std::min(kSamples, subset.size()));
  parallel_chunks(found.size(), threads, kSamples / 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      throw_if_cancelled();
      found[s] = std::sqrt(nth_distance_sq(subset, subset[s * subset.size() / kSamples], k / stride));
    }
  });
  std::vector<S> typical;
  for (const S d : found)
    if (d > 0 && std::isfinite(d)) typical.push_back(d);
  return typical.empty() ? S(1) : median(typical);
}

}  // namespace agrisee::detail
