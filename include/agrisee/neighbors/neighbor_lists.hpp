// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Lists of the nearest points of all points of a cloud, for stages that need the neighbors more than once.
#pragma once

#include <agrisee/neighbors/all_neighbors.hpp>

#include <limits>

namespace agrisee {

/// The k nearest points of every point of a cloud.
struct NeighborLists {
  std::size_t k = 0;  ///< number of neighbors per point
  Indices ids;  ///< k per point, nearest first, including the point itself; -1 if there are fewer or it is not finite

  /// Number of points.
  std::size_t size() const { return k == 0 ? 0 : ids.size() / k; }
  /// Calls f(j) for the neighbors j of point i, nearest first.
  template <typename F>
  void visit(std::size_t i, F&& f) const {
    for (std::size_t j = i * k; j < (i + 1) * k && ids[j] >= 0; ++j) f(ids[j]);
  }
};

/// Finds the k >= 1 nearest points of every point of a cloud. Memory: 4 k bytes per point.
template <typename C>
NeighborLists nearest_neighbors(const C& cloud, std::size_t k, int threads = 1) {
  using S = scalar_t<C>;
  constexpr S kInfinity = std::numeric_limits<S>::infinity();
  NeighborLists out{k, Indices(agrisee::size(cloud) * k, -1)};
  const detail::NeighborhoodGrid<S> near(cloud, k, kInfinity, threads);
  const auto& ids = near.grid.ids();
  const auto list = [&](std::size_t j, const Neighborhood<S>& found, int) {
    Index* const to = out.ids.data() + static_cast<std::size_t>(ids[j]) * k;
    for (std::size_t i = 0; i < found.size; ++i) to[i] = found.id(i);
  };
  detail::for_stored_neighborhoods<Order::nearest_first>(cloud, near, k, kInfinity, threads, list);
  return out;
}

}  // namespace agrisee
