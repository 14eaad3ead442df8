// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The grid in which points vote for the centers of round bodies; sphere_voting.hpp says how they vote. Metres.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/geometry/aabb.hpp>

#include <cstddef>
#include <cstdint>

namespace agrisee::detail {

/// The cells that are voted for. Their coordinates are counted from one in each axis, and packed into one integer, z
/// first, with as many bits an axis as the voters need.
class VoteGrid {
 public:
  /// Coordinates of a cell, in cells.
  using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

  /// @param cloud the points that vote (m) and their normals
  /// @param radius_max largest radius that is voted for (m)
  /// @param edge edge length of a cell (m)
  template <typename S>
  VoteGrid(const PointCloud<S>& cloud, double radius_max, double edge) : pitch(edge) {
    bool first = true;
    Aabb box;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!is_finite(cloud.points[i])) continue;
      if (first) origin = cloud.points[i].template cast<double>();
      first = false;
      const Eigen::Vector3d p = cloud.points[i].template cast<double>() - origin;
      if (p.cwiseAbs().maxCoeff() <= widest(radius_max)) box.extend(p);
    }
    if (box.empty()) return;
    const auto cell_of = [&](const Eigen::Vector3d& p) -> Cell {
      return (p / pitch).array().floor().cast<std::int64_t>();
    };
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(kReach * radius_max);
    before = cell_of(box.min - reach) - Cell::Constant(2);
    const Cell most = cell_of(box.max + reach) - before + Cell::Constant(3);
    while (most.x() >> y_shift_ != 0) ++y_shift_;
    z_shift_ = y_shift_;
    while (most.y() >> (z_shift_ - y_shift_) != 0) ++z_shift_;
  }

  /// Whether a normal is long enough to show a direction, and so short that its votes lie in the grid.
  template <typename S>
  static bool admits(const Vector3<S>& normal) {
    const S length_sq = normal.squaredNorm();
    return length_sq > S(0.5) && length_sq < S(2);
  }

  /// Points farther from the origin than this along an axis (m) do not vote: 21 bits an axis hold no more.
  double widest(double radius_max) const { return pitch * double((1 << 20) - 8) - kReach * radius_max; }

  /// The integer of the cell with these coordinates; smaller for a smaller z, then y, then x.
  std::uint64_t pack(std::uint64_t x, std::uint64_t y, std::uint64_t z) const {
    return z << z_shift_ | y << y_shift_ | x;
  }
  /// The coordinates of a packed cell.
  Cell unpack(std::uint64_t key) const {
    const auto low = [](std::uint64_t value, unsigned bits) {
      return static_cast<std::int64_t>(value & ((1ull << bits) - 1));
    };
    return {low(key, y_shift_), low(key >> y_shift_, z_shift_ - y_shift_), static_cast<std::int64_t>(key >> z_shift_)};
  }

  /// The number of a cell in its line, which runs along x.
  std::size_t x(std::uint64_t key) const { return static_cast<std::size_t>(key & (cells_of_line() - 1)); }
  /// The number of a cell's line: that of its plane, which z gives, times the lines of a plane, and y.
  std::uint64_t line(std::uint64_t key) const { return key >> y_shift_; }
  /// How many cells a line can have.
  std::uint64_t cells_of_line() const { return std::uint64_t{1} << y_shift_; }
  /// How many lines a plane can have.
  std::uint64_t lines_of_plane() const { return std::uint64_t{1} << (z_shift_ - y_shift_); }

  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< the first finite point (m), the center of cell `-before`
  double pitch;                                      ///< edge length of a cell (m)
  Cell before = Cell::Zero();                        ///< cell of the origin's grid that would be number 0

 private:
  static constexpr double kReach = 1.5;  // farthest vote of a point, in largest radii: the longest normal admitted
  unsigned y_shift_ = 0, z_shift_ = 0;
};

}  // namespace agrisee::detail
