// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A neighbour search that grows: points are added one by one to the cells of an unbounded hashed grid. For radii of at
/// most about twice the cell; `Grid` and `KdTree` are faster where the cloud is known beforehand.
/// Insertion O(1); a query reads the cells that its ball touches. Memory about 16 bytes a point and 24 a cell (S =
/// float).
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/neighbors.hpp>
#include <agrisee/core/random.hpp>

#include <cmath>

namespace agrisee {

/// Integer coordinates of a cell.
using CellIndex = Eigen::Matrix<std::int32_t, 3, 1>;

/// From cells to values: open addressing with linear probing, at most half full.
class CellTable {
 public:
  /// Cells reach from -kLimit to kLimit on every axis.
  static constexpr std::int32_t kLimit = (1 << 20) - 1;

  /// The coordinate of the cell that holds x, given 1 / edge length; everything beyond the limit shares the last cell.
  static std::int32_t coordinate(double x, double inverse_edge) {
    const double c = x * inverse_edge;
    if (c < -double(kLimit)) return -kLimit;
    if (c >= double(kLimit)) return kLimit;
    const auto whole = static_cast<std::int32_t>(c);  // towards zero; a call of floor would cost more than all the rest
    return whole - (c < double(whole) ? 1 : 0);
  }

  /// The cell that holds p (m), given 1 / edge length.
  template <typename S>
  static CellIndex cell(const Vector3<S>& p, double inverse_edge) {
    return {coordinate(double(p.x()), inverse_edge), coordinate(double(p.y()), inverse_edge),
            coordinate(double(p.z()), inverse_edge)};
  }

  /// Number of cells that hold something.
  std::size_t size() const { return used_; }

  /// The value of a cell, or -1.
  Index find(const CellIndex& cell) const {
    if (slots_.empty()) return -1;
    const std::uint64_t key = pack(cell);
    for (std::size_t s = mix(key) & mask_;; s = (s + 1) & mask_) {
      if (slots_[s].value < 0) return -1;
      if (slots_[s].key == key) return slots_[s].value;
    }
  }

  /// Set the value (>= 0) of a cell and return the one that it replaces, or -1.
  Index exchange(const CellIndex& cell, Index value) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    const std::uint64_t key = pack(cell);
    for (std::size_t s = mix(key) & mask_;; s = (s + 1) & mask_) {
      if (slots_[s].value >= 0 && slots_[s].key != key) continue;
      const Index old = slots_[s].value;
      if (old < 0) ++used_;
      slots_[s] = {key, value};
      return old;
    }
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    Index value = -1;
  };

  static std::uint64_t pack(const CellIndex& c) {
    const auto bits = [](std::int32_t x) { return static_cast<std::uint64_t>(x + kLimit) & 0x1FFFFF; };
    return bits(c.x()) << 42 | bits(c.y()) << 21 | bits(c.z());
  }

  void grow() {
    std::vector<Slot> old(std::max<std::size_t>(64, 2 * slots_.size()));
    old.swap(slots_);
    mask_ = slots_.size() - 1;
    for (const Slot& slot : old) {
      if (slot.value < 0) continue;
      std::size_t s = mix(slot.key) & mask_;
      while (slots_[s].value >= 0) s = (s + 1) & mask_;
      slots_[s] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::size_t mask_ = 0, used_ = 0;
};

/// A growing set of points; `radius`, `count`, `visit` and `size` as in neighbors.hpp.
template <typename S>
class HashGrid {
 public:
  /// @param cell edge length of a cell (m), > 0; twice the usual query radius serves best
  /// @throws ParameterError when `cell` is not positive and finite
  explicit HashGrid(S cell) : inverse_(1.0 / double(cell)) {
    check_parameter(std::isfinite(cell) && cell > 0 && std::isfinite(inverse_), "grid cell", "positive and finite",
                    cell);
  }

  /// Number of points.
  std::size_t size() const { return points_.size(); }

  /// Point i, as inserted.
  const Vector3<S>& point(std::size_t i) const { return points_[i]; }

  /// Add a point and return its index, the number of those before it. One that is not finite is never found.
  Index insert(const Vector3<S>& p) {
    const auto i = static_cast<Index>(points_.size());
    points_.push_back(p);
    next_.push_back(is_finite(p) ? cells_.exchange(cell_of(p.template cast<double>()), i) : -1);
    return i;
  }

  /// True when some point is strictly nearer to q than r.
  bool nearer(const Vector3<S>& q, S r) const {
    bool found = false;
    scan(q, r, [&](Index, S d_sq) { return !(found = d_sq < r * r); });
    return found;
  }

  /// How many points are within r; see neighbors.hpp.
  std::size_t count(const Vector3<S>& q, S r, std::size_t cap = kNoCap) const {
    std::size_t found = 0;
    if (cap > 0) scan(q, r, [&](Index, S d_sq) { return !(d_sq <= r * r && ++found == cap); });
    return found;
  }

  /// Calls f for all points within r; see neighbors.hpp.
  template <typename F>
  void visit(const Vector3<S>& q, S r, F&& f) const {
    scan(q, r, [&](Index i, S d_sq) {
      if (d_sq <= r * r) f(i, d_sq);
      return true;
    });
  }

  /// All points within r; see neighbors.hpp.
  void radius(const Vector3<S>& q, S r, Neighbors<S>& out) const {
    out.clear();
    visit(q, r, [&](Index i, S d_sq) { out.push_back({i, d_sq}); });
    std::sort(out.begin(), out.end(), detail::Nearest<S>::before);
    for (Neighbor<S>& n : out) n.distance = std::sqrt(n.distance);
  }

 private:
  CellIndex cell_of(const Eigen::Vector3d& p) const { return CellTable::cell(p, inverse_); }

  /// f(index, distance_sq) for every point of the cells that the ball touches, until it returns false.
  template <typename F>
  void scan(const Vector3<S>& q, S r, F&& f) const {
    if (!(r >= 0) || !is_finite(q) || points_.empty()) return;
    const Eigen::Vector3d d = q.template cast<double>();
    // A margin for the rounding of q - p in S.
    const double margin = 4.0 * double(std::numeric_limits<S>::epsilon()) * (d.cwiseAbs().maxCoeff() + double(r));
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(double(r) + margin);
    const CellIndex lo = cell_of(d - reach), hi = cell_of(d + reach);
    const Eigen::Vector3d span = (hi - lo).cast<double>() + Eigen::Vector3d::Ones();
    if (span.prod() > 2.0 * double(cells_.size()) + 27.0) {  // fewer cells than the ball touches: read all points
      for (std::size_t i = 0; i < points_.size(); ++i)
        if (is_finite(points_[i]) && !f(static_cast<Index>(i), distance_sq<S>(points_[i], q))) return;
      return;
    }
    CellIndex c;
    for (c.z() = lo.z(); c.z() <= hi.z(); ++c.z())
      for (c.y() = lo.y(); c.y() <= hi.y(); ++c.y())
        for (c.x() = lo.x(); c.x() <= hi.x(); ++c.x())
          for (Index i = cells_.find(c); i >= 0; i = next_[static_cast<std::size_t>(i)])
            if (!f(i, distance_sq<S>(points_[static_cast<std::size_t>(i)], q))) return;
  }

  CellTable cells_;  // the last point inserted into each cell
  std::vector<Vector3<S>> points_;
  std::vector<Index> next_;  // the point inserted into the same cell before, or -1
  double inverse_;
};

}  // namespace agrisee
