// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Neighbor search by a uniform grid (cell list). A query reads the rows of cells near it, each of which is one run in
/// memory. It is fastest for radii near the cell size. For the cost of building and the memory see
/// detail/grid_points.hpp. Searches for all points of a cloud at once are several times as fast by all_neighbors.hpp
/// and count_neighbors.hpp.
#pragma once

#include <agrisee/neighbors/detail/grid_points.hpp>
#include <agrisee/neighbors/neighbors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace agrisee {

/// A grid over the finite points of a cloud; see neighbors.hpp for the interface.
template <typename S>
class Grid : public detail::GridPoints<S> {
 public:
  /// @param cloud points (m), any cloud type
  /// @param cell edge length of a cell (m), > 0; half to one times the usual query radius is best
  /// @param threads the result does not depend on it
  /// @throws ParameterError if `cell` is not positive and finite; InputError if the width of the cloud is not a finite
  ///         number; Cancelled
  template <typename C>
  Grid(const C& cloud, S cell, int threads = 1) : detail::GridPoints<S>(cloud, cell, threads) {}

  /// Finds all points within r; see neighbors.hpp.
  void radius(const Vector3<S>& q, S r, Neighbors<S>& out) const { detail::sorted_radius(*this, q, r, out); }

  /// Counts the points within r; see neighbors.hpp.
  std::size_t count(const Vector3<S>& q, S r, std::size_t cap = kNoCap) const {
    if (!(r >= 0) || cap == 0) return 0;
    std::size_t found = 0;
    const S r_sq = r * r;
    const auto distance_sq = distance_sq_from(q);
    rows(q, r, [&](std::size_t begin, std::size_t end) {
      unsigned in = 0;
      for (std::size_t j = begin; j < end; ++j) in += distance_sq(j) <= r_sq ? 1u : 0u;
      found += in;
      return found < cap;
    });
    return std::min(found, cap);
  }

  /// Calls f(index, distance_sq) for all points within r; see neighbors.hpp.
  template <typename F>
  void visit(const Vector3<S>& q, S r, F&& f) const {
    if (!(r >= 0)) return;
    const S r_sq = r * r;
    const auto distance_sq = distance_sq_from(q);
    rows(q, r, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        const S d_sq = distance_sq(j);
        if (d_sq <= r_sq) f(this->ids()[j], d_sq);
      }
      return true;
    });
  }

  /// Finds the k nearest points; see neighbors.hpp.
  void knn(const Vector3<S>& q, std::size_t k, Neighbors<S>& out) const {
    k = std::min(k, this->stored());
    detail::Nearest<S> nearest(out, k);
    if (k > 0 && is_finite(q)) {
      // Searches balls of growing radius about q, until the k-th nearest point is within the radius. Doubling the
      // radius reads a few cells again, but needs few steps when q is far away or the cloud is sparse.
      const Eigen::Vector3d d = q.template cast<double>();
      const detail::CellLattice& lattice = this->lattice();
      const Eigen::Vector3d size = lattice.cell() * lattice.dims();
      const Eigen::Vector3d outside = (lattice.min() - d).cwiseMax(d - (lattice.min() + size)).cwiseMax(0.0);
      const auto distance_sq = distance_sq_from(q);
      for (double reach = outside.norm() + lattice.cell();; reach *= 2.0) {
        out.clear();
        rows(q, static_cast<S>(reach), [&](std::size_t begin, std::size_t end) {
          for (std::size_t j = begin; j < end; ++j) nearest.offer(distance_sq(j), this->ids()[j]);
          return true;
        });
        if (nearest.full() && std::sqrt(static_cast<double>(nearest.worst_sq())) <= reach) break;
        // Now the ball holds the whole grid.
        if (reach > outside.norm() + 2.0 * lattice.cell() * lattice.dims().norm()) break;
      }
    }
    nearest.finish();
  }

 private:
  auto distance_sq_from(const Vector3<S>& q) const {
    return detail::distance_sq_from(q, this->x().data(), this->y().data(), this->z().data());
  }

  /// Calls body(begin, end) for each run of stored points that may lie within r of q, until it returns false.
  template <typename Body>
  void rows(const Vector3<S>& q, S r, Body&& body) const {
    if (this->stored() == 0 || !is_finite(q)) return;
    const detail::CellLattice& lattice = this->lattice();
    const Eigen::Vector3d d = q.template cast<double>();
    // The margin allows for the rounding of q - p in S.
    const double reach =
        double(r) + 4.0 * double(std::numeric_limits<S>::epsilon()) * (d.cwiseAbs().maxCoeff() + double(r));
    const double reach_sq = reach * reach;
    Eigen::Vector3i lo, hi;
    for (int a = 0; a < 3; ++a) {
      const double low = lattice.min()[a], high = low + lattice.cell() * double(lattice.dim(a));
      if (d[a] + reach < low || d[a] - reach > high) return;
      lo[a] = lattice.coordinate(d[a] - reach, a);
      hi[a] = lattice.coordinate(d[a] + reach, a);
    }
    if (this->fewer_blocks_than(double(hi[1] - lo[1] + 1) * double(hi[2] - lo[2] + 1))) {
      body(std::size_t(0), this->stored());
      return;
    }
    for (int z = lo[2]; z <= hi[2]; ++z) {
      const double gz = lattice.gap(d[2], z, 2);
      for (int y = lo[1]; y <= hi[1]; ++y) {
        const double gy = lattice.gap(d[1], y, 1);
        if (gz * gz + gy * gy > reach_sq) continue;
        const auto [begin, end] = this->row(lo[0], hi[0], y, z);
        if (begin != end && !body(begin, end)) return;
      }
    }
  }
};

/// The scalar type of a grid is that of its cloud.
template <typename C, typename T>
Grid(const C&, T) -> Grid<scalar_t<C>>;
/// The scalar type of a grid is that of its cloud.
template <typename C, typename T>
Grid(const C&, T, int) -> Grid<scalar_t<C>>;

}  // namespace agrisee
