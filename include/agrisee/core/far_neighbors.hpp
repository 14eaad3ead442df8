// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The nearest points of those that are astray: a kd-tree of a grid's occupied cells leads to the cells, whose points
/// are tried block by block.
#pragma once

#include <agrisee/core/grid.hpp>
#include <agrisee/core/kdtree.hpp>
#include <agrisee/core/neighborhood.hpp>
#include <agrisee/core/sums.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// The occupied cells of a grid in a kd-tree, for points whose neighbours are not in the next cells.
template <typename S>
class FarCells {
 public:
  explicit FarCells(const Grid<S>& grid) : grid_(grid), half_diagonal_(S(0.8661) * static_cast<S>(grid.cell())) {
    std::vector<Vector3<S>> centers;
    grid.cells(0, grid.stored(), [&](const typename Grid<S>::Cell& c, std::size_t begin, std::size_t end) {
      runs_.emplace_back(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
      centers.push_back(grid.center(c));
    });
    tree_.emplace(centers);
  }

  const Grid<S>& grid() const { return grid_; }

  /// f(begin, end) for the stored points of cells, near ones first; none that holds a point at most sqrt(`limit_sq`)
  /// (m) from q is left out. f may lower `limit_sq` (m2).
  /// @return false where the limit, with the cells' size, was too large at last to be squared: any may be left out then
  template <typename F>
  bool approach(const Vector3<S>& q, const S& limit_sq, F&& f) const {
    const S rounding = S(8) * std::numeric_limits<S>::epsilon() * (q.cwiseAbs().maxCoeff() + half_diagonal_);
    const auto far_sq = [&] {  // of centers of cells that reach so near
      const S far = S(1.001) * (std::sqrt(limit_sq) + half_diagonal_) + rounding;
      return far * far;
    };
    S last_sq = limit_sq, center_sq = far_sq();
    tree_->approach(q, center_sq, [&](Index c, S) {
      const auto [begin, end] = runs_[static_cast<std::size_t>(c)];
      f(begin, end);
      if (limit_sq != last_sq) last_sq = limit_sq, center_sq = far_sq();
    });
    return std::isfinite(S(4) * center_sq);
  }

 private:
  const Grid<S>& grid_;
  S half_diagonal_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> runs_;  // stored points of each occupied cell
  std::optional<KdTree<S>> tree_;
};

/// Picks the nearest of the points of near cells; not to be shared between threads.
template <typename S>
class FarNearest {
 public:
  FarNearest(const FarCells<S>& cells, std::size_t k) : cells_(cells), k_(k) {}

  /// The k stored points nearest to q that are at most `radius` away (m).
  const Neighborhood<S>& operator()(const Vector3<S>& q, S radius) {
    const Grid<S>& grid = cells_.grid();
    begin(radius);
    const auto try_cell = [&](std::size_t first, std::size_t last) { offer(q, first, last); };
    if (!cells_.approach(q, limit_sq_, try_cell)) {  // all are wanted, or too far for S to tell how far
      begin(radius);
      offer(q, 0, grid.stored());
    }
    std::sort(found_.begin(), found_.end(), before());
    found_.resize(std::min(found_.size(), k_));
    distance_sq_.clear(), at_.clear();
    for (const Found& f : found_) distance_sq_.push_back(f.d_sq), at_.push_back(f.at);
    near_ = {at_.size(),      distance_sq_.data(), at_.data(), grid.x().data(),
             grid.y().data(), grid.z().data(),     nullptr,    grid.ids().data()};
    end_at_last(near_);
    return near_;
  }

 private:
  struct Found {
    S d_sq;
    std::uint32_t at;  // among the stored points
  };
  auto before() const {
    return [ids = cells_.grid().ids().data()](const Found& a, const Found& b) {
      return a.d_sq < b.d_sq || (a.d_sq == b.d_sq && ids[a.at] < ids[b.at]);
    };
  }

  void begin(S radius) {
    found_.clear();
    limit_sq_ = radius * radius;
    room_ = k_;
  }
  /// Keep those of the stored points [first, last) that may be among the k.
  void offer(const Vector3<S>& q, std::size_t first, std::size_t last) {
    const Grid<S>& grid = cells_.grid();
    constexpr std::size_t kBlock = Grid<S>::kBlock;
    const S *x = grid.x().data(), *y = grid.y().data(), *z = grid.z().data();
    const S qx = q.x(), qy = q.y(), qz = q.z();
    for (; first < last; first += kBlock) {
      S d_sq[kBlock];
      for (std::size_t l = 0; l < kBlock; ++l) {  // may be some points too many
        const S dx = x[first + l] - qx, dy = y[first + l] - qy, dz = z[first + l] - qz;
        d_sq[l] = sum_of_squares(dx, dy, dz);
      }
      unsigned near = 0;
      for (std::size_t l = 0; l < kBlock; ++l) near |= d_sq[l] <= limit_sq_ ? 1u : 0u;
      if (near == 0) continue;
      const std::size_t size = std::min(kBlock, last - first);
      for (std::size_t l = 0; l < size; ++l)
        if (d_sq[l] <= limit_sq_) keep(d_sq[l], first + l);
    }
  }
  void keep(S d_sq, std::size_t j) {
    found_.push_back({d_sq, static_cast<std::uint32_t>(j)});
    if (found_.size() < room_) return;
    const auto last_of_k = found_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(found_.begin(), last_of_k, found_.end(), before());
    limit_sq_ = last_of_k->d_sq;
    found_.resize(k_);
    room_ = 2 * k_;
  }

  const FarCells<S>& cells_;
  std::size_t k_, room_ = 0;
  S limit_sq_ = 0;
  std::vector<Found> found_;
  std::vector<S> distance_sq_;
  std::vector<std::uint32_t> at_;
  Neighborhood<S> near_;
};

}  // namespace agrisee::detail
