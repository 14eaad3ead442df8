// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Thins a cloud: one point, the mean, for each occupied cell of a grid anchored at the origin.
/// Metres. Cost O(n): a sort of 16 bytes a point, by as many digits as the cloud is wide in cells; O(n log n) for clouds
/// that reach a million cells from the origin.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/core/hash_grid.hpp>
#include <agrisee/core/radix_sort.hpp>

namespace agrisee {

namespace detail {

/// The finite points in the order of their cells of edge `leaf` (m), by z, then y, then x; equal keys are one cell.
template <typename S>
std::vector<Keyed> by_cell(const std::vector<Vector3<S>>& points, double leaf) {
  const double inverse = 1.0 / leaf;
  std::vector<Keyed> order;
  order.reserve(points.size());
  CellIndex least = CellIndex::Constant(CellTable::kLimit), most = -least;
  std::vector<CellIndex> cells;
  cells.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3<S>& p = points[i];
    if (!is_finite(p)) continue;
    order.push_back({0, static_cast<Index>(i)});
    cells.emplace_back(CellTable::coordinate(double(p.x()), inverse), CellTable::coordinate(double(p.y()), inverse),
                       CellTable::coordinate(double(p.z()), inverse));
    least = least.cwiseMin(cells.back());
    most = most.cwiseMax(cells.back());
  }
  if (order.empty()) return order;
  if (least.minCoeff() > -CellTable::kLimit && most.maxCoeff() < CellTable::kLimit) {
    // Rows of cells one after the other: as few digits as the cloud needs, at most 63 bits.
    const Eigen::Matrix<std::uint64_t, 3, 1> across = (most - least).cast<std::uint64_t>();
    for (std::size_t j = 0; j < order.size(); ++j) {
      const Eigen::Matrix<std::uint64_t, 3, 1> c = (cells[j] - least).cast<std::uint64_t>();
      order[j].key = (c.z() * (across.y() + 1) + c.y()) * (across.x() + 1) + c.x();
    }
    radix_sort(order);
    return order;
  }
  // A cell that far from the origin has no small integers for a name.
  const auto cell = [&](Index i) {
    const Eigen::Vector3d c = points[static_cast<std::size_t>(i)].template cast<double>() * inverse;
    return std::array<double, 3>{std::floor(c.z()), std::floor(c.y()), std::floor(c.x())};
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const Keyed& a, const Keyed& b) { return cell(a.index) < cell(b.index); });
  for (std::size_t j = 1; j < order.size(); ++j)
    order[j].key = order[j - 1].key + (cell(order[j].index) != cell(order[j - 1].index) ? 1u : 0u);
  return order;
}

}  // namespace detail

/// The mean point of every cell of edge `leaf` (m) that holds finite points, cells by z, then y, then x.
/// Normals, where all points have them, are averaged and made unit; views are dropped.
/// @param cloud points (m)
/// @param leaf edge of the voxels (m)
/// @param members if given, receives the number of points behind each mean
/// @throws ParameterError when `leaf` is not positive
template <typename S>
PointCloud<S> average_in_voxels(const PointCloud<S>& cloud, double leaf, std::vector<int>* members = nullptr) {
  check_parameter(std::isfinite(leaf) && leaf > 0, "leaf", "positive", leaf);
  const std::vector<Keyed> order = detail::by_cell(cloud.points, leaf);
  const bool with_normals = cloud.normals.size() == cloud.points.size();
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

}  // namespace agrisee
