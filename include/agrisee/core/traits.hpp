// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What any point cloud type has to provide so that the library can read it without copying.
///
/// This file covers `std::vector<Eigen::Matrix<S, 3, 1>>` and dense Eigen expressions (matrices, maps with any stride,
/// blocks) with three rows, where each column is a point, or with three columns, where each row is a point. Specialize
/// `CloudTraits<C>` for other types; `interop/` does so for PCL, Open3D and ROS.
#pragma once

#include <agrisee/core/types.hpp>

#include <type_traits>
#include <utility>

namespace agrisee {

/// `Scalar`, `size(cloud)` and `point(cloud, i)` of a cloud type `C`. Types that may hold normals also have
/// `normal(cloud, i)`: a unit vector towards the side from which the surface was seen, or zero if unknown.
template <typename C, typename Enable = void>
struct CloudTraits;

/// Traits of vectors of Eigen vectors.
template <typename S, typename A>
struct CloudTraits<std::vector<Vector3<S>, A>> {
  using Scalar = S;  ///< type of a coordinate
  /// Number of points.
  static std::size_t size(const std::vector<Vector3<S>, A>& c) { return c.size(); }
  /// Point i (m).
  static const Vector3<S>& point(const std::vector<Vector3<S>, A>& c, std::size_t i) { return c[i]; }
};

/// Traits of dense Eigen expressions with three rows or columns.
template <typename C>
struct CloudTraits<C, std::enable_if_t<std::is_base_of<Eigen::DenseBase<C>, C>::value &&
                                       (C::RowsAtCompileTime == 3 || C::ColsAtCompileTime == 3)>> {
  using Scalar = typename C::Scalar;                            ///< type of a coordinate
  static constexpr bool by_column = C::RowsAtCompileTime == 3;  ///< true if each column is a point
  /// Number of points.
  static std::size_t size(const C& c) { return static_cast<std::size_t>(by_column ? c.cols() : c.rows()); }
  /// Point i (m).
  static Vector3<Scalar> point(const C& c, std::size_t i) {
    const auto j = static_cast<Eigen::Index>(i);
    if constexpr (by_column)
      return c.col(j);
    else
      return c.row(j).transpose();
  }
};

/// Type of a coordinate of a cloud.
template <typename C>
using scalar_t = typename CloudTraits<C>::Scalar;

/// Number of points of a cloud.
template <typename C>
std::size_t size(const C& cloud) {
  return CloudTraits<C>::size(cloud);
}

/// Point i of a cloud (m), 0 <= i < size(cloud).
template <typename C>
decltype(auto) point(const C& cloud, std::size_t i) {
  return CloudTraits<C>::point(cloud, i);
}

namespace detail {

/// True if CloudTraits<C> has `normal`.
template <typename C, typename = void>
struct KnowsNormals : std::false_type {};
template <typename C>
struct KnowsNormals<C, std::void_t<decltype(CloudTraits<C>::normal(std::declval<const C&>(), std::size_t{}))>>
    : std::true_type {};

}  // namespace detail
}  // namespace agrisee
