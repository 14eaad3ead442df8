// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The contract that a foreign point cloud meets to be used without copying: its scalar, its size, its point i.
///
/// Fulfilled here for `std::vector<Eigen::Matrix<S, 3, 1>>` and for every dense Eigen expression with three rows
/// (a point a column) or, failing that, three columns (a point a row): matrices, maps over any stride, blocks.
/// Specialise `CloudTraits<C>` for others; see `interop/` for examples (PCL, Open3D, ROS).
#pragma once

#include <agrisee/core/types.hpp>

#include <type_traits>
#include <utility>

namespace agrisee {

/// `Scalar`, `size(cloud)` and `point(cloud, i)` of a cloud type `C`; where it may know normals also `normal(cloud,
/// i)`: a unit vector towards the side from which the surface was seen, or zero, which means unknown.
template <typename C, typename Enable = void>
struct CloudTraits;

/// Vectors of Eigen vectors.
template <typename S, typename A>
struct CloudTraits<std::vector<Vector3<S>, A>> {
  /// Of coordinates.
  using Scalar = S;
  /// Number of points.
  static std::size_t size(const std::vector<Vector3<S>, A>& c) { return c.size(); }
  /// Point i (m).
  static const Vector3<S>& point(const std::vector<Vector3<S>, A>& c, std::size_t i) { return c[i]; }
};

/// Dense Eigen expressions with three rows or columns.
template <typename C>
struct CloudTraits<C, std::enable_if_t<std::is_base_of<Eigen::DenseBase<C>, C>::value &&
                                       (C::RowsAtCompileTime == 3 || C::ColsAtCompileTime == 3)>> {
  /// Of coordinates.
  using Scalar = typename C::Scalar;
  /// Whether a point is a column.
  static constexpr bool by_column = C::RowsAtCompileTime == 3;
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

/// Scalar of a cloud's coordinates.
template <typename C>
using scalar_t = typename CloudTraits<C>::Scalar;

/// Number of points of a cloud.
template <typename C>
std::size_t size(const C& cloud) {
  return CloudTraits<C>::size(cloud);
}

/// Point i of a cloud (metres), 0 <= i < size(cloud).
template <typename C>
decltype(auto) point(const C& cloud, std::size_t i) {
  return CloudTraits<C>::point(cloud, i);
}

namespace detail {

/// Whether the traits of C have `normal`.
template <typename C, typename = void>
struct KnowsNormals : std::false_type {};
template <typename C>
struct KnowsNormals<C, std::void_t<decltype(CloudTraits<C>::normal(std::declval<const C&>(), std::size_t{}))>>
    : std::true_type {};

}  // namespace detail
}  // namespace agrisee
