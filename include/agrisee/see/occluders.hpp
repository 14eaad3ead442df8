// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What can block lines of sight: the points of a growing cloud, ready for the questions of occlusion.hpp. World frame,
/// metres. Most balls along a line of sight hold no points, which one look-up in a table of cells shows; only balls
/// near points are searched. Cost: O(1) per point and per empty ball.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/neighbors/hash_grid.hpp>

namespace agrisee::see {

/// The points of a cloud as occluders.
class Occluders {
 public:
  /// @param upsilon radius about a line of sight that must be free of points (m), > 0
  explicit Occluders(double upsilon)
      : upsilon_(upsilon),
        inverse_(1.0 / ((1.0 + kSlack) * upsilon)),
        points_(static_cast<float>(2.0 * upsilon)),
        sparse_(static_cast<float>(2.0 * upsilon)) {}

  /// Add a point (m, world).
  void insert(const Eigen::Vector3f& p) {
    bounds_.extend(p.cast<double>());
    points_.insert(p);
    if (!sparse_.nearer(p, static_cast<float>(upsilon_))) sparse_.insert(p);
    const CellIndex cell = CellTable::cell(p, inverse_);
    if (occupied_.exchange(cell, 0) >= 0) return;
    CellIndex d;
    for (d.z() = -1; d.z() <= 1; ++d.z())
      for (d.y() = -1; d.y() <= 1; ++d.y())
        for (d.x() = -1; d.x() <= 1; ++d.x()) {
          const CellIndex near = cell + d;
          if (near.cwiseAbs().maxCoeff() <= CellTable::kLimit) near_.exchange(near, 0);
        }
  }

  /// Number of points within r of q (m), at most `cap`; see neighbors.hpp.
  std::size_t count(const Eigen::Vector3f& q, float r, std::size_t cap = kNoCap) const {
    return nothing_near(q, r) ? 0 : points_.count(q, r, cap);
  }

  /// Some of the points, no two of them nearer than upsilon, as HashGrid.
  const HashGrid<float>& sparse() const { return sparse_; }
  /// Box about the points (m, world).
  const Aabb& bounds() const { return bounds_; }

 private:
  static constexpr double kSlack = 0.01;  // cells are larger than upsilon by this share, for what is rounded

  /// True if no point can be within r of q. A ball of radius upsilon reaches no farther than into the cells around its
  /// center's.
  bool nothing_near(const Eigen::Vector3f& q, float r) const {
    if (!(double(r) <= (1.0 + 0.1 * kSlack) * upsilon_) || !is_finite(q)) return false;
    const double rounding = 8.0 * double(std::numeric_limits<float>::epsilon()) * double(q.cwiseAbs().maxCoeff());
    return rounding < 0.5 * kSlack * upsilon_ && near_.find(CellTable::cell(q, inverse_)) < 0;
  }

  double upsilon_, inverse_;
  HashGrid<float> points_;  // in cells of 2 upsilon
  HashGrid<float> sparse_;
  CellTable occupied_;  // cells of about upsilon that hold points
  CellTable near_;      // these cells and all cells around them
  Aabb bounds_;
};

}  // namespace agrisee::see
