// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Statistical outlier removal (Rusu et al., 2008; [1], 2.2.2, eq. 5 to 9): a point is dropped if the mean
/// distance d_i to its K nearest neighbors exceeds mu + alpha sigma, where mu and sigma are the mean and the standard
/// deviation of all d_i.
///
/// Any frame, metres. Cost O(n K): a grid and, mostly, finding some 20 neighbors per point.
///
/// The K neighbors do not include the point itself, but a duplicate of it counts, at distance 0. K means the same in
/// PCL's `setMeanK(K)`. Open3D's `nb_neighbors` counts the point itself: K + 1 there is K here (the sums are the same,
/// and mean, deviation and threshold scale alike). Both divide the squares by N - 1, which is `sample_deviation`; [1]
/// divides by N. Open3D also drops points with d_i = 0, which are kept here.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/neighbors/all_neighbors.hpp>

#include <limits>

namespace agrisee {

/// Mean distance (m) of every point to its `k` nearest others: d_i of [1]. If there are fewer others, their mean; 0 for
/// a point alone; NaN for a point that is not finite; infinite if squares of distances overflow.
/// @param cloud points (m), any cloud type
/// @param k how many others
/// @param search a KdTree or Grid over `cloud`
/// @param threads the result does not depend on it
/// @throws InputError if the search is over a cloud of another size
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
      // The point itself is at distance 0. Among more than k duplicates it may not be in the list, but then one of them
      // takes its place.
      double sum = 0.0;
      for (const auto& neighbor : found) sum += static_cast<double>(neighbor.distance);
      distances[i] = found.size() > 1 ? sum / static_cast<double>(found.size() - 1) : 0.0;
    }
  });
  return distances;
}

namespace detail {

/// Indices of the points with d_i <= mu + alpha sigma. Points with infinite d_i do not count in mu and sigma and are
/// dropped, unless all d_i are infinite. Points with d_i = NaN are dropped.
inline Indices within_deviation(const std::vector<double>& distances, const SorParameters& parameters) {
  double sum = 0.0, squares = 0.0, n = 0.0;
  for (const double d : distances)
    if (std::isfinite(d)) sum += d, n += 1.0;
  const double mean = n > 0.0 ? sum / n : std::numeric_limits<double>::infinity();
  for (const double d : distances)
    if (std::isfinite(d)) squares += (d - mean) * (d - mean);
  const double degrees = parameters.sample_deviation ? n - 1.0 : n;
  const double sigma = degrees > 0.0 ? std::sqrt(squares / degrees) : 0.0;
  // The factor covers the rounding of the mean if all d_i are equal.
  const double threshold = (mean + parameters.std_ratio * sigma) * (1.0 + 1e-12);
  Indices kept;
  kept.reserve(distances.size());
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (distances[i] <= threshold) kept.push_back(static_cast<Index>(i));
  return kept;
}

}  // namespace detail

/// The mean distances without a ready-made search; several times as fast.
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

/// Find the points that are no outliers; the cloud is not changed. Points that are not finite, or so far from K others
/// that the square of the distance overflows, are outliers, and do not count in mean and deviation. If all d_i are
/// equal (even infinite), all points stay; so do a single point and points that all coincide.
/// @param cloud points (m), any cloud type
/// @param parameters see their struct
/// @param search a KdTree or Grid over `cloud`
/// @param threads the result does not depend on it
/// @return indices of the points that stay, ascending
/// @throws ParameterError for a bad parameter, InputError if the search is over a cloud of another size
template <typename C, typename Search>
Indices remove_statistical_outliers(const C& cloud, const SorParameters& parameters, const Search& search,
                                    int threads = 1) {
  parameters.check();
  return detail::within_deviation(mean_neighbor_distances(cloud, parameters.mean_k, search, threads), parameters);
}

/// remove_statistical_outliers without a ready-made search; several times as fast.
/// @throws ParameterError for a bad parameter
template <typename C>
Indices remove_statistical_outliers(const C& cloud, const SorParameters& parameters = {}, int threads = 1) {
  parameters.check();
  return detail::within_deviation(mean_neighbor_distances(cloud, parameters.mean_k, threads), parameters);
}

}  // namespace agrisee
