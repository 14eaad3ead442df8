// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a view observed as a whole, kept points or not: the mean of its points, and the free space that it shows
/// (SEE++). World frame, metres. Cost: O(1) per point, and some 30 table look-ups per question.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/neighbors/hash_grid.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace agrisee::see {

/// All points of one view.
class Observation {
 public:
  /// An angle (rad) about a direction: points nearer to it than this are compared with a position in that direction.
  static constexpr double kBeam = 0.01;

  /// Nothing was observed.
  Observation() = default;

  /// @param cloud points of the view, any cloud type (m, world); points that are not finite are left out
  /// @param sensor position of the sensor (m, world)
  template <typename C>
  Observation(const C& cloud, const Eigen::Vector3d& sensor) : sensor_(sensor) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    CellIndex last = CellIndex::Constant(CellTable::kLimit);
    std::size_t slot = 0;
    for (std::size_t i = 0; i < agrisee::size(cloud); ++i) {
      const auto p = point(cloud, i);
      if (!is_finite(p)) continue;
      const Eigen::Vector3d at = p.template cast<double>();
      sum += at;
      ++size_;
      const Eigen::Vector3d line = at - sensor;
      const double range = line.norm();
      if (!(range > 0.0)) continue;
      const CellIndex cell = CellTable::cell(Eigen::Vector3d(line / range), kCells);
      if (cell != last) slot = slot_of(last = cell);
      nearest_[slot] = std::min(nearest_[slot], range);
    }
    if (size_ > 0) centroid_ = sum / static_cast<double>(size_);
  }

  /// Number of points.
  std::size_t size() const { return size_; }
  /// Mean of the points (m, world); zero if there are none.
  const Eigen::Vector3d& centroid() const { return centroid_; }

  /// Whether p (m, world) is not in free space: the view saw a point nearer to the sensor than p, within about kBeam of
  /// its direction. Directions are compared in cells of half that width.
  bool hides(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d line = p - sensor_;
    const double range = line.norm();
    if (!(range > 0.0)) return false;
    const CellIndex middle = CellTable::cell(Eigen::Vector3d(line / range), kCells);
    CellIndex d;
    for (d.z() = -2; d.z() <= 2; ++d.z())
      for (d.y() = -2; d.y() <= 2; ++d.y())
        for (d.x() = -2; d.x() <= 2; ++d.x()) {
          if (d.squaredNorm() > 4) continue;
          const Index slot = table_.find(middle + d);
          if (slot >= 0 && nearest_[static_cast<std::size_t>(slot)] < range) return true;
        }
    return false;
  }

 private:
  static constexpr double kCells = 2.0 / kBeam;  // cells of directions per unit length

  std::size_t slot_of(const CellIndex& cell) {
    Index slot = table_.find(cell);
    if (slot < 0) {
      slot = static_cast<Index>(nearest_.size());
      table_.exchange(cell, slot);
      nearest_.push_back(std::numeric_limits<double>::infinity());
    }
    return static_cast<std::size_t>(slot);
  }

  Eigen::Vector3d sensor_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d centroid_ = Eigen::Vector3d::Zero();
  std::size_t size_ = 0;
  CellTable table_;              // by cells of unit vectors
  std::vector<double> nearest_;  // per cell: distance of its nearest point from the sensor (m)
};

}  // namespace agrisee::see
