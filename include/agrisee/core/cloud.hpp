// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// AgriSEE's own point cloud: points and, if known, their normals, the view that each came from, their colors and
/// what a detector took them for.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/core/traits.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>
#include <string>

namespace agrisee {

/// A point cloud as a structure of arrays. All but `points` are empty or as long as `points`.
template <typename S>
struct PointCloud {
  std::vector<Vector3<S>> points;   ///< m, in the world frame unless said otherwise
  std::vector<Vector3<S>> normals;  ///< unit normals towards the side that was seen; zero = unknown
  std::vector<int> views;           ///< index of the view that observed the point; -1 = unknown
  std::vector<Rgb> colors = {};     ///< measured colors
  std::vector<int> instances = {};  ///< number of a detector's instance in the point's view; 0 = none

  /// Number of points.
  std::size_t size() const { return points.size(); }
  /// True if there are no points.
  bool empty() const { return points.empty(); }
};

/// Check that each array of a cloud is empty or as long as `points`.
/// @throws InputError that names the array and both lengths
template <typename S>
void check_lengths(const PointCloud<S>& cloud) {
  const auto check = [&](const char* name, const auto& values) {
    if (!values.empty() && values.size() != cloud.points.size())
      throw InputError("the cloud has " + std::to_string(cloud.points.size()) + " points, but " +
                       std::to_string(values.size()) + " " + name + ": there must be one for each point, or none");
  };
  check("normals", cloud.normals);
  check("views", cloud.views);
  check("colors", cloud.colors);
  check("instances", cloud.instances);
}

/// Traits of AgriSEE's own clouds.
template <typename S>
struct CloudTraits<PointCloud<S>> {
  using Scalar = S;  ///< type of a coordinate
  /// Number of points.
  static std::size_t size(const PointCloud<S>& c) { return c.points.size(); }
  /// Point i (m).
  static const Vector3<S>& point(const PointCloud<S>& c, std::size_t i) { return c.points[i]; }
  /// Unit normal i, or zero if it is not known.
  static Vector3<S> normal(const PointCloud<S>& c, std::size_t i) {
    return c.normals.empty() ? Vector3<S>(Vector3<S>::Zero()) : c.normals[i];
  }
};

/// The cloud type of the pipeline. Single precision resolves 0.1 um at arm's length and halves the memory traffic.
using Cloud = PointCloud<float>;

/// True if all three coordinates are finite.
template <typename V>
bool is_finite(const V& p) {
  return std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z());
}

/// Indices of the points whose coordinates are all finite, ascending. O(n).
template <typename C>
Indices finite_indices(const C& cloud) {
  Indices kept;
  kept.reserve(agrisee::size(cloud));
  for (std::size_t i = 0; i < agrisee::size(cloud); ++i)
    if (is_finite(point(cloud, i))) kept.push_back(static_cast<Index>(i));
  return kept;
}

/// Copies the finite points of any cloud, in single precision, with their normals if the traits know any. O(n).
/// @throws Cancelled
template <typename C>
Cloud finite_points(const C& cloud) {
  Cloud out;
  bool any_normal = false;
  out.points.reserve(agrisee::size(cloud));
  if constexpr (detail::KnowsNormals<C>::value) out.normals.reserve(agrisee::size(cloud));
  for (std::size_t i = 0; i < agrisee::size(cloud); ++i) {
    if ((i & 0x3FFF) == 0) throw_if_cancelled();
    const Eigen::Vector3f p = point(cloud, i).template cast<float>();
    if (!is_finite(p)) continue;
    out.points.push_back(p);
    if constexpr (detail::KnowsNormals<C>::value) {
      out.normals.push_back(CloudTraits<C>::normal(cloud, i).template cast<float>());
      any_normal = any_normal || !out.normals.back().isZero(0.0f);
    }
  }
  if (!any_normal) out.normals.clear();
  return out;
}

/// Copies the points `indices` of any cloud; points only.
template <typename C>
PointCloud<scalar_t<C>> select(const C& cloud, const Indices& indices) {
  PointCloud<scalar_t<C>> out;
  out.points.reserve(indices.size());
  for (Index i : indices) out.points.push_back(point(cloud, static_cast<std::size_t>(i)));
  return out;
}

/// Copies the points `indices` of a PointCloud with all that is known of them.
/// @throws InputError as check_lengths
template <typename S>
PointCloud<S> select(const PointCloud<S>& cloud, const Indices& indices) {
  check_lengths(cloud);
  PointCloud<S> out;
  const auto copy = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(indices.size());
    for (const Index i : indices) to.push_back(from[static_cast<std::size_t>(i)]);
  };
  copy(cloud.points, out.points);
  copy(cloud.normals, out.normals);
  copy(cloud.views, out.views);
  copy(cloud.colors, out.colors);
  copy(cloud.instances, out.instances);
  return out;
}

}  // namespace agrisee
