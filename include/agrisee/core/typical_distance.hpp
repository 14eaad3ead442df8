// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How far apart the points of a cloud are, judged by a few of them: what cells and first guesses of searches go by.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>
#include <agrisee/core/neighbors.hpp>
#include <agrisee/core/parallel.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace agrisee::detail {

/// The value of that rank, from 0, among squared distances from q to many points; of the last one where there are
/// fewer. One pass: few of them are among the least so far.
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

/// Median, over a few points of the cloud, of the distance (m) to the k-th nearest, judged by a share of the points;
/// points with that many duplicates do not count. 1 where there are no others.
template <typename C>
scalar_t<C> typical_distance(const C& cloud, std::size_t k, int threads = 1) {
  using S = scalar_t<C>;
  constexpr std::size_t kSamples = 16;
  const std::size_t n = agrisee::size(cloud), share = std::max<std::size_t>(1, k / 4);
  std::vector<Vector3<S>> some;
  some.reserve(n / share + 1);
  for (std::size_t i = 0; i < n; i += share)
    if (is_finite(point(cloud, i))) some.push_back(point(cloud, i));
  std::vector<S> found(std::min(kSamples, some.size()));
  parallel_chunks(found.size(), threads, kSamples / 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      throw_if_cancelled();
      found[s] = std::sqrt(nth_distance_sq(some, some[s * some.size() / kSamples], k / share));
    }
  });
  std::vector<S> typical;
  for (const S d : found)
    if (d > 0 && std::isfinite(d)) typical.push_back(d);
  if (typical.empty()) return S(1);
  const auto middle = typical.begin() + static_cast<std::ptrdiff_t>(typical.size() / 2);
  std::nth_element(typical.begin(), middle, typical.end());
  return *middle;
}

}  // namespace agrisee::detail
