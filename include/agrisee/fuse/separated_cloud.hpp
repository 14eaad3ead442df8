// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Merges views by minimum separation (SEE++): a new point is kept if no kept point is nearer than epsilon; nothing is
/// averaged. Metres. Cost: a few cells per point.
#pragma once

#include <agrisee/neighbors/hash_grid.hpp>

namespace agrisee::fuse {

/// The growing cloud.
class SeparatedCloud {
 public:
  /// @param separation epsilon (m), > 0
  /// @throws ParameterError
  explicit SeparatedCloud(double separation) : separation_(static_cast<float>(separation)), grid_(2.0f * separation_) {}

  /// The points kept so far, with their views.
  const Cloud& cloud() const { return cloud_; }

  /// Offer a point of view `view`; true if it is kept. Points that are not finite are never kept.
  bool add(const Eigen::Vector3f& p, int view) {
    if (!is_finite(p) || grid_.nearer(p, separation_)) return false;
    grid_.insert(p);
    cloud_.points.push_back(p);
    cloud_.views.push_back(view);
    return true;
  }

  /// Keep only the points `kept` (ascending indices).
  void keep(const Indices& kept) {
    cloud_ = select(cloud_, kept);
    grid_ = HashGrid<float>(2.0f * separation_);
    for (const auto& p : cloud_.points) grid_.insert(p);
  }

 private:
  float separation_;
  HashGrid<float> grid_;
  Cloud cloud_;
};

}  // namespace agrisee::fuse
