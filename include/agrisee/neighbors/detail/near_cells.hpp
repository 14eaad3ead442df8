// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A quick test of whether a cloud can have points near a place: one byte per cell of a coarse lattice. Metres.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/geometry/aabb.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace agrisee::detail {

/// The cells that hold a point of a cloud, or touch one that does. Building is linear in the points.
class NearCells {
 public:
  /// @param cloud any cloud type; points that are not finite are left out
  /// @param reach edge length of a cell (m), positive; it is widened a little, to be safe from rounding
  template <typename C>
  NearCells(const C& cloud, double reach) {
    constexpr double kMostCells = 1 << 24, kMargin = 1e-3;
    Aabb box;
    const std::size_t count = agrisee::size(cloud);
    for (std::size_t i = 0; i < count; ++i)
      if (is_finite(point(cloud, i))) box.extend(point(cloud, i).template cast<double>());
    if (box.empty()) {
      known_ = true;
      return;
    }
    const double largest = box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).maxCoeff();
    edge_ = (1.0 + kMargin) * reach + 8.0 * double(std::numeric_limits<scalar_t<C>>::epsilon()) * largest;
    const Eigen::Array3d dims = (box.size() / edge_).array().floor() + 4.0;  // 1.5 cells more on each side
    known_ = dims.prod() <= kMostCells;
    if (!known_) return;
    dims_ = dims.cast<int>();
    min_ = box.min.array() - 1.5 * edge_;
    near_.assign(static_cast<std::size_t>(dims.prod()), 0);
    std::vector<char> holds(near_.size(), 0);
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_finite(point(cloud, i))) continue;
      const std::size_t at = cell(point(cloud, i).template cast<double>());
      if (!holds[at]) mark_around(at);
      holds[at] = 1;
    }
  }

  /// False only if no point of the cloud is within the reach of a place (m).
  bool maybe(const Eigen::Vector3d& place) const {
    if (!known_) return true;
    if (near_.empty()) return false;
    const Eigen::Array3d c = (place.array() - min_) / edge_;
    return (c >= 0.0).all() && (c < dims_.cast<double>()).all() && near_[cell(place)] != 0;
  }

 private:
  std::size_t cell(const Eigen::Vector3d& place) const {
    const Eigen::Array3i c = ((place.array() - min_) / edge_).cast<int>();
    return (std::size_t(c.z()) * std::size_t(dims_.y()) + std::size_t(c.y())) * std::size_t(dims_.x()) +
           std::size_t(c.x());
  }

  /// Mark a cell, which is not at the border of the lattice, and the 26 around it.
  void mark_around(std::size_t at) {
    const std::size_t row = std::size_t(dims_.x()), slice = row * std::size_t(dims_.y());
    for (const std::size_t z : {at - slice, at, at + slice})
      for (const std::size_t y : {z - row, z, z + row})
        for (const std::size_t x : {y - 1, y, y + 1}) near_[x] = 1;
  }

  bool known_ = false;  // false: there would be too many cells
  double edge_ = 0.0;   // of a cell (m)
  Eigen::Array3d min_ = Eigen::Array3d::Zero();
  Eigen::Array3i dims_ = Eigen::Array3i::Zero();
  std::vector<char> near_;  // one per cell, x fastest
};

}  // namespace agrisee::detail
