// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A neighbor search to which points can be added, by an unbounded grid of hashed cells. It suits radii up to about
/// twice the cell size. `Grid` and `KdTree` are faster if the whole cloud is known from the start. Insertion is O(1); a
/// query reads the cells that its ball touches. Memory: about 16 bytes per point and 24 per cell (S = float).
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/neighbors/neighbors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace agrisee {

/// Integer coordinates of a cell.
using CellIndex = Eigen::Matrix<std::int32_t, 3, 1>;

/// A hash table from cells to values: open addressing with linear probing, at most half full.
class CellTable {
 public:
  /// Cell coordinates lie between -kLimit and kLimit.
  static constexpr std::int32_t kLimit = (1 << 20) - 1;

  /// The coordinate of the cell that holds x (m), for cells of edge length 1 / inverse_edge. Everything beyond the
  /// limit counts as in the outermost cell.
  static std::int32_t coordinate(double x, double inverse_edge) {
    const double c = x * inverse_edge;
    if (c < -double(kLimit)) return -kLimit;
    if (c >= double(kLimit)) return kLimit;
    const auto whole =
        static_cast<std::int32_t>(c);  // rounds towards zero; calling std::floor would take longer than all the rest
    return whole - (c < double(whole) ? 1 : 0);
  }

  /// The cell that holds p (m), for cells of edge length 1 / inverse_edge.
  template <typename S>
  static CellIndex cell(const Vector3<S>& p, double inverse_edge) {
    return {coordinate(double(p.x()), inverse_edge), coordinate(double(p.y()), inverse_edge),
            coordinate(double(p.z()), inverse_edge)};
  }

  /// Number of cells that have a value.
  std::size_t size() const { return used_; }

  /// The value of a cell, or -1 if it has none.
  Index find(const CellIndex& cell) const {
    if (slots_.empty()) return -1;
    const std::uint64_t key = pack(cell);
    for (std::size_t s = mix(key) & mask_;; s = (s + 1) & mask_) {
      if (slots_[s].value < 0) return -1;
      if (slots_[s].key == key) return slots_[s].value;
    }
  }

  /// Sets the value (>= 0) of a cell and returns the one that it replaces, or -1.
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

/// A growing set of points, with `radius`, `count`, `visit` and `size` as in neighbors.hpp.
template <typename S>
class HashGrid {
 public:
  /// @param cell edge length of a cell (m), > 0; twice the usual query radius is best
  /// @throws ParameterError if `cell` is not positive and finite
  explicit HashGrid(S cell) : inverse_(1.0 / double(cell)) {
    check_parameter(std::isfinite(cell) && cell > 0 && std::isfinite(inverse_), "grid cell", "positive and finite",
                    cell);
  }

  /// Number of points.
  std::size_t size() const { return points_.size(); }

  /// Point i, counted in the order of insertion (m).
  const Vector3<S>& point(std::size_t i) const { return points_[i]; }

  /// Adds a point (m) and returns its index, which is the number of points before it. A point that is not finite is
  /// counted but never found.
  Index insert(const Vector3<S>& p) {
    const auto i = static_cast<Index>(points_.size());
    points_.push_back(p);
    next_.push_back(is_finite(p) ? cells_.exchange(cell_of(p.template cast<double>()), i) : -1);
    return i;
  }

  /// True if some point is nearer to q than r, not just at r.
  bool nearer(const Vector3<S>& q, S r) const {
    bool found = false;
    scan(q, r, [&](Index, S d_sq) { return !(found = d_sq < r * r); });
    return found;
  }

  /// Counts the points within r; see neighbors.hpp.
  std::size_t count(const Vector3<S>& q, S r, std::size_t cap = kNoCap) const {
    std::size_t found = 0;
    if (cap > 0) scan(q, r, [&](Index, S d_sq) { return !(d_sq <= r * r && ++found == cap); });
    return found;
  }

  /// Calls f(index, distance_sq) for all points within r; see neighbors.hpp.
  template <typename F>
  void visit(const Vector3<S>& q, S r, F&& f) const {
    scan(q, r, [&](Index i, S d_sq) {
      if (d_sq <= r * r) f(i, d_sq);
      return true;
    });
  }

  /// Finds all points within r; see neighbors.hpp.
  void radius(const Vector3<S>& q, S r, Neighbors<S>& out) const { detail::sorted_radius(*this, q, r, out); }

 private:
  CellIndex cell_of(const Eigen::Vector3d& p) const { return CellTable::cell(p, inverse_); }

  /// Calls f(index, distance_sq) for every point of the cells that the ball touches, until it returns false.
  template <typename F>
  void scan(const Vector3<S>& q, S r, F&& f) const {
    if (!(r >= 0) || !is_finite(q) || points_.empty()) return;
    const Eigen::Vector3d d = q.template cast<double>();
    // The margin allows for the rounding of q - p in S.
    const double margin = 4.0 * double(std::numeric_limits<S>::epsilon()) * (d.cwiseAbs().maxCoeff() + double(r));
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(double(r) + margin);
    const CellIndex lo = cell_of(d - reach), hi = cell_of(d + reach);
    const Eigen::Vector3d span = (hi - lo).cast<double>() + Eigen::Vector3d::Ones();
    if (span.prod() > 2.0 * double(cells_.size()) + 27.0) {  // the ball touches more cells than there are
      for (std::size_t i = 0; i < points_.size(); ++i)
        if (is_finite(points_[i]) && !f(static_cast<Index>(i), distance_sq<S>(points_[i], q))) return;
      return;
    }
    CellIndex c;
    for (c.z() = lo.z(); c.z() <= hi.z(); ++c.z())
      for (c.y() = lo.y(); c.y() <= hi.y(); ++c.y())
        for (c.x() = lo.x(); c.x() <= hi.x(); ++c.x())
          for (Index i = cells_.find(c); i >= 0; i = at(next_, i))
            if (!f(i, distance_sq<S>(at(points_, i), q))) return;
  }

  CellTable cells_;  // the point last inserted into each cell
  std::vector<Vector3<S>> points_;
  std::vector<Index> next_;  // for each point: the one inserted into the same cell before it, or -1
  double inverse_;
};

}  // namespace agrisee
