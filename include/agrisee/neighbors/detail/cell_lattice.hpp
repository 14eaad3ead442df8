// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The cells of a uniform grid over an axis-aligned box: which cell holds a point, and how far away cells are.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace agrisee::detail {

/// Integer coordinates of a cell, from 0, in the order z, y, x: cells in ascending order are in the order of their
/// keys.
using GridCell = std::array<int, 3>;

/// Cubic cells that cover a box.
class CellLattice {
 public:
  CellLattice() = default;
  /// @param min,max corners of the box (m); min <= max
  /// @param cell edge length of a cell (m), > 0; it is made longer if the box would be wider than 2^30 cells
  /// @throws InputError if the width of the box is not a finite number
  CellLattice(const Eigen::Vector3d& min, const Eigen::Vector3d& max, double cell) : min_(min) {
    constexpr double kMaxCells = 1 << 30;  // along an axis
    constexpr double kMinLength = 1e-290;  // m; its inverse is still finite
    const double longest = 2.0 * (0.5 * max - 0.5 * min_).maxCoeff();
    check_input(std::isfinite(longest), "grid: the width of the cloud is not a finite number");
    cell_ = std::max({cell, longest / kMaxCells, kMinLength});
    inverse_ = 1.0 / cell_;
    for (int a = 0; a < 3; ++a) dims_[a] = static_cast<int>((max[a] - min_[a]) * inverse_) + 1;
  }

  /// Edge length of a cell (m).
  double cell() const { return cell_; }
  /// Number of cells along an axis (0 = x).
  int dim(int axis) const { return dims_[axis]; }
  /// Number of cells along each axis.
  Eigen::Vector3d dims() const { return dims_.cast<double>(); }
  /// Number of cells; a floating-point number, since it may exceed 64 bits.
  double cells() const { return double(dims_[0]) * double(dims_[1]) * double(dims_[2]); }
  /// Lowest corner of the box (m).
  const Eigen::Vector3d& min() const { return min_; }

  /// Coordinate of the cell that holds x (m) along an axis; for an x outside the box that of the nearest cell.
  int coordinate(double x, int axis) const {
    const double c = (x - min_[axis]) * inverse_;  // not negative where it is cast, so the cast rounds down
    return c <= 0.0 ? 0 : c >= double(dims_[axis]) ? dims_[axis] - 1 : static_cast<int>(c);
  }
  /// The cell that holds p (m).
  template <typename S>
  GridCell cell_of(const Vector3<S>& p) const {
    return {coordinate(double(p.z()), 2), coordinate(double(p.y()), 1), coordinate(double(p.x()), 0)};
  }
  /// The number of a cell, counted along x, then y, then z. It must fit into std::size_t.
  std::size_t key(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(dims_[1]) + std::size_t(y)) * std::size_t(dims_[0]) + std::size_t(x);
  }
  std::size_t key(const GridCell& c) const { return key(c[2], c[1], c[0]); }

  /// Center of a cell (m).
  Eigen::Vector3d center(const GridCell& c) const {
    return min_ + cell_ * (Eigen::Vector3d(c[2], c[1], c[0]).array() + 0.5).matrix();
  }
  /// Distance (m) along an axis from x to the cells with coordinate c; slightly too small, to allow for rounding.
  double gap(double x, int c, int axis) const {
    const double low = min_[axis] + cell_ * double(c), high = low + cell_;
    const double slack = 1e-9 * cell_;
    return std::max({low - slack - x, x - high - slack, 0.0});
  }
  /// Distance (m) from q, which lies in cell c, to the nearest cell of the box that is more than `rings` cells from c;
  /// infinite if there is none.
  template <typename S>
  double clearance(const Vector3<S>& q, const GridCell& c, int rings) const {
    double out = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
      const int i = at(c, 2 - a);
      const double d = double(q[a]) - min_[a];
      if (i - rings > 0) out = std::min(out, d - cell_ * double(i - rings));
      if (i + rings < dims_[a] - 1) out = std::min(out, cell_ * double(i + rings + 1) - d);
    }
    return out - 4e-6 * cell_;
  }

 private:
  Eigen::Vector3d min_ = Eigen::Vector3d::Zero();
  double cell_ = 1.0, inverse_ = 1.0;
  Eigen::Vector3i dims_ = Eigen::Vector3i::Ones();
};

}  // namespace agrisee::detail
