// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Statistical outlier removal (Rusu et al., 2008; paper, "Outlier and Noise Removal"): a point goes when the mean
/// distance d_i to its K nearest neighbours exceeds mu + alpha sigma, mu and sigma being the mean and the deviation of
/// all d_i.
///
/// Any frame, metres. Cost: a grid and the picking of some 20 neighbours a point, which bounds it, O(n K).
///
/// The K neighbours are others than the point itself, which is left out by its index: a duplicate of it counts, at
/// distance 0. PCL's `setMeanK(K)` means the same K, Open3D's `nb_neighbors` counts the point: K + 1 there is K here
/// (both sums are the same, and mean, deviation and threshold scale alike). Both divide the squares by N - 1, which is
/// `sample_deviation`; the paper divides by N. Open3D also drops points with d_i = 0, which stay here.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/all_neighbors.hpp>

#include <limits>

namespace agrisee {

/// Mean distance (m) of every point to its `k` nearest others: the paper's d_i. Where there are fewer, the mean of
/// those there are; 0 for a point alone; NaN for a point that is not finite; infinite where squares of distances
/// overflow.
/// @param cloud points (m), any cloud type
/// @param k how many others
/// @param search a KdTree or Grid over `cloud`
/// @param threads the result does not depend on it
/// @throws InputError when the search is over a cloud of another size
template <typename C, typename Search>
std::vector<double> mean_neighbor_distances(const C& cloud, int k, const Search& search, int threads = 1) {
  const std::size_t n = agrisee::size(cloud);
  check_input(search.size() == n, "the search and the cloud differ in size");
  std::vector<double> distances(n, std::numeric_limits<double>::quiet_NaN());
  parallel_chunks(n, threads, 512, [&](std::size_t begin, std::size_t end) {
    Neighbors<scalar_t<C>> found;
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3<scalar_t<C>> p = point(cloud, i);
      if (!is_finite(p)) continue;
      search.knn(p, static_cast<std::size_t>(std::max(k, 0)) + 1, found);
      // The point itself is at distance 0. Among more than k duplicates it may not be in the list; one of them stands
      // for it.
      double sum = 0.0;
      for (const auto& neighbor : found) sum += static_cast<double>(neighbor.distance);
      distances[i] = found.size() > 1 ? sum / static_cast<double>(found.size() - 1) : 0.0;
    }
  });
  return distances;
}

namespace detail {

/// The points with d_i <= mu + alpha sigma. Those whose d_i is infinite do not count and go, unless all are: then
/// nothing sets one apart. Those with NaN go.
inline Indices within_deviation(const std::vector<double>& distances, const SorParameters& params) {
  double sum = 0.0, squares = 0.0, n = 0.0;
  for (const double d : distances)
    if (std::isfinite(d)) sum += d, n += 1.0;
  const double mean = n > 0.0 ? sum / n : std::numeric_limits<double>::infinity();
  for (const double d : distances)
    if (std::isfinite(d)) squares += (d - mean) * (d - mean);
  const double degrees = params.sample_deviation ? n - 1.0 : n;
  const double sigma = degrees > 0.0 ? std::sqrt(squares / degrees) : 0.0;
  // The factor covers the rounding of the mean where all d_i are equal.
  const double threshold = (mean + params.std_ratio * sigma) * (1.0 + 1e-12);
  Indices kept;
  kept.reserve(distances.size());
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (distances[i] <= threshold) kept.push_back(static_cast<Index>(i));
  return kept;
}

}  // namespace detail

/// The same without a search; several times as fast.
template <typename C>
std::vector<double> mean_neighbor_distances(const C& cloud, int k, int threads = 1) {
  using S = scalar_t<C>;
  std::vector<double> distances(agrisee::size(cloud), std::numeric_limits<double>::quiet_NaN());
  const auto mean = [&](Index i, const Neighborhood<S>& near) {
    double sum = 0.0;
    for (std::size_t j = 0; j < near.size; ++j) sum += static_cast<double>(std::sqrt(near.distance_sq[j]));
    distances[static_cast<std::size_t>(i)] = near.size > 1 ? sum / static_cast<double>(near.size - 1) : 0.0;
  };
  for_each_neighborhood<Order::any>(cloud, static_cast<std::size_t>(std::max(k, 0)) + 1,
                                    std::numeric_limits<S>::infinity(), threads, mean);
  return distances;
}

/// Indices of the points that stay, ascending; the cloud is not changed. Points that are not finite, or so far from K
/// others that the square of the distance overflows, go, and do not count in mean and deviation. A single point, or
/// points that all coincide, stay; so does any cloud whose d_i are all equal, infinite ones too.
/// @param cloud points (m), any cloud type
/// @param params see their struct
/// @param search a KdTree or Grid over `cloud`
/// @param threads the result does not depend on it
/// @throws ParameterError for a bad parameter, InputError when the search is over a cloud of another size
template <typename C, typename Search>
Indices remove_statistical_outliers(const C& cloud, const SorParameters& params, const Search& search,
                                    int threads = 1) {
  params.check();
  return detail::within_deviation(mean_neighbor_distances(cloud, params.mean_k, search, threads), params);
}

/// The same without a search; several times as fast.
/// @throws ParameterError for a bad parameter
template <typename C>
Indices remove_statistical_outliers(const C& cloud, const SorParameters& params = {}, int threads = 1) {
  params.check();
  return detail::within_deviation(mean_neighbor_distances(cloud, params.mean_k, threads), params);
}

}  // namespace agrisee
