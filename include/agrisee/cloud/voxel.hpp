// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Thins a cloud: the points in each cell of a grid anchored at the origin are replaced by their mean.
/// Metres. Cost O(n): a radix sort of 16 bytes a point, with more digits the more cells the cloud is wide; O(n log n)
/// for clouds that reach a million cells from the origin.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/neighbors/detail/radix_sort.hpp>
#include <agrisee/neighbors/hash_grid.hpp>

namespace agrisee {

namespace detail {

/// The finite points in the order of their cells, by z, then y, then x. Cells are numbered from the cell `least`.
/// @param inverse 1 / edge length of a cell (1/m)
/// @param across number of cells along each axis
template <typename Key, typename S>
Uninitialized<Keyed<Key>> by_number(const std::vector<Vector3<S>>& points, double inverse, const CellIndex& least,
                                    const Eigen::Matrix<Key, 3, 1>& across) {
  Uninitialized<Keyed<Key>> order;
  order.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points[i])) continue;
    const Eigen::Matrix<Key, 3, 1> c = (CellTable::cell(points[i], inverse) - least).template cast<Key>();
    order.push_back({(c.z() * across.y() + c.y()) * across.x() + c.x(), static_cast<Index>(i)});
  }
  radix_sort(order);
  return order;
}

/// The finite points in the order of their cells, for cells too far from the origin for small integer coordinates.
template <typename S>
Uninitialized<Keyed<std::uint64_t>> by_far_cell(const std::vector<Vector3<S>>& points, double inverse) {
  Uninitialized<Keyed<std::uint64_t>> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_finite(points[i])) order.push_back({0, static_cast<Index>(i)});
  const auto cell = [&](const auto& item) {
    const Eigen::Vector3d c = points[static_cast<std::size_t>(item.index)].template cast<double>() * inverse;
    return std::array<double, 3>{std::floor(c.z()), std::floor(c.y()), std::floor(c.x())};
  };
  std::stable_sort(order.begin(), order.end(), [&](const auto& a, const auto& b) { return cell(a) < cell(b); });
  for (std::size_t j = 1; j < order.size(); ++j)
    order[j].key = order[j - 1].key + (cell(order[j]) != cell(order[j - 1]) ? 1u : 0u);
  return order;
}

/// Call f(order) with the finite points in the order of their cells, by z, then y, then x. Points with equal keys are
/// in one cell.
/// @param leaf edge length of a cell (m)
template <typename S, typename F>
void by_cell(const std::vector<Vector3<S>>& points, double leaf, F&& f) {
  const double inverse = 1.0 / leaf;
  Vector3<S> min = Vector3<S>::Constant(std::numeric_limits<S>::max()), max = -min;
  for (const Vector3<S>& p : points) {
    if (!is_finite(p)) continue;
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  if (!(min.x() <= max.x())) return f(Uninitialized<Keyed<std::uint32_t>>());
  const CellIndex least = CellTable::cell(min, inverse), most = CellTable::cell(max, inverse);
  if (least.minCoeff() <= -CellTable::kLimit || most.maxCoeff() >= CellTable::kLimit)
    return f(by_far_cell(points, inverse));
  const Eigen::Matrix<std::int64_t, 3, 1> across = (most - least).template cast<std::int64_t>().array() + 1;
  if (across.template cast<double>().prod() < 4294967296.0)
    f(by_number<std::uint32_t>(points, inverse, least, across.template cast<std::uint32_t>().eval()));
  else  // at most 63 bits
    f(by_number<std::uint64_t>(points, inverse, least, across.template cast<std::uint64_t>().eval()));
}

/// The mean point of each run of equal keys; see average_in_voxels.
template <typename S, typename Order>
PointCloud<S> average_runs(const PointCloud<S>& cloud, const Order& order, std::vector<int>* members) {
  const bool with_normals = !cloud.normals.empty();
  std::size_t occupied = order.empty() ? 0 : 1;
  for (std::size_t j = 1; j < order.size(); ++j) occupied += order[j].key != order[j - 1].key ? 1u : 0u;
  PointCloud<S> out;
  out.points.reserve(occupied);
  if (with_normals) out.normals.reserve(occupied);
  if (members) members->clear();
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    const Eigen::Vector3d origin = cloud.points[static_cast<std::size_t>(order[begin].index)].template cast<double>();
    for (; end < order.size() && order[end].key == order[begin].key; ++end) {
      const auto i = static_cast<std::size_t>(order[end].index);
      sum += cloud.points[i].template cast<double>() - origin;
      if (with_normals) normal += cloud.normals[i].template cast<double>();
    }
    const auto n = static_cast<double>(end - begin);
    out.points.push_back((origin + sum / n).template cast<S>());
    if (with_normals) {
      const double length = normal.norm();
      out.normals.push_back(length > 1e-9 ? Vector3<S>((normal / length).template cast<S>()) : Vector3<S>::Zero());
    }
    if (members) members->push_back(static_cast<int>(end - begin));
    begin = end;
  }
  return out;
}

}  // namespace detail

/// The mean point of every cell that holds finite points, in the order of the cells by z, then y, then x. If the cloud
/// has normals, they are averaged and scaled to unit length (zero if they cancel out). Views, colors and instances are
/// left out: where you need them, take those of the point nearest to each mean.
/// @param cloud points (m)
/// @param leaf edge length of the cells (m)
/// @param members if given, receives the number of points behind each mean
/// @throws ParameterError if `leaf` is not finite, not positive or so small that 1 / `leaf` is not finite; InputError
///   as check_lengths
template <typename S>
PointCloud<S> average_in_voxels(const PointCloud<S>& cloud, double leaf, std::vector<int>* members = nullptr) {
  check_parameter(std::isfinite(leaf) && leaf > 0, "leaf", "positive and finite", leaf);
  check_parameter(std::isfinite(1.0 / leaf), "leaf", "so large that 1 / leaf is finite", leaf);
  check_lengths(cloud);
  PointCloud<S> out;
  detail::by_cell(cloud.points, leaf, [&](const auto& order) { out = detail::average_runs(cloud, order, members); });
  return out;
}

}  // namespace agrisee
