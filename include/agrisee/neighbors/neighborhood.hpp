// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The neighbors of one point, in the form in which for_each_neighborhood (all_neighbors.hpp) passes them on.
#pragma once

#include <agrisee/core/types.hpp>

#include <cstdint>

namespace agrisee {

/// The k nearest points of one point, including itself. It is a view of arrays that are valid during the call only.
template <typename S>
struct Neighborhood {
  std::size_t size = 0;               ///< number of neighbors
  const S* distance_sq = nullptr;     ///< squared distance of each neighbor (m2)
  const std::uint32_t* at = nullptr;  ///< position of each neighbor in the arrays x, y and z
  const S* x = nullptr;               ///< x[at[i]] is the x coordinate of neighbor i (m)
  const S* y = nullptr;               ///< as x
  const S* z = nullptr;               ///< as x
  const std::uint32_t* stored =
      nullptr;                 ///< position of point x[j], y[j], z[j] among the grid's stored points, or null
  const Index* ids = nullptr;  ///< indices in the cloud: of the stored points, or of x, y, z if `stored` is null
  /// Bound of the neighborhood: the neighbors are exactly the points with a squared distance (m2) below `last_sq`,
  /// and those at `last_sq` whose index is at most `last`. Several values satisfy this; which one is unspecified.
  S last_sq = 0;
  Index last = 0;  ///< see last_sq

  /// Neighbor i (m).
  Vector3<S> point(std::size_t i) const { return {x[at[i]], y[at[i]], z[at[i]]}; }
  /// Index in the cloud of neighbor i.
  Index id(std::size_t i) const { return ids[stored ? stored[at[i]] : at[i]]; }
};

/// The order of the points of a neighborhood.
enum class Order {
  any,           ///< unspecified, but always the same for the same cloud
  nearest_first  ///< by distance, then by index
};

}  // namespace agrisee
