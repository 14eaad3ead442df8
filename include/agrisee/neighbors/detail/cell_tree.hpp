// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds the k nearest points of points that have few others near them. A kd-tree over the occupied cells of a grid
/// leads to the cells, nearest first, and the points of these are tested block by block.
#pragma once

#include <agrisee/neighbors/detail/grid_points.hpp>
#include <agrisee/neighbors/detail/k_nearest.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/neighbors/neighborhood.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// A kd-tree over the centers of a grid's occupied cells.
template <typename S>
class CellTree {
 public:
  explicit CellTree(const GridPoints<S>& grid) : grid_(grid), half_diagonal_(S(0.8661) * static_cast<S>(grid.cell())) {
    std::vector<Vector3<S>> centers;
    grid.cells(0, grid.stored(), [&](const GridCell& c, std::size_t begin, std::size_t end) {
      runs_.emplace_back(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
      centers.push_back(grid.center(c));
    });
    tree_.emplace(centers);
  }

  const GridPoints<S>& grid() const { return grid_; }

  /// Calls f(begin, end) for the stored points of cells, roughly nearest cells first. It misses no cell that holds a
  /// point within sqrt(limit_sq) (m) of q. f may lower `limit_sq` (m2) in the meantime.
  /// @return false if the final limit was too large to be squared in S; then any cell may have been missed
  template <typename F>
  bool approach(const Vector3<S>& q, const S& limit_sq, F&& f) const {
    const S rounding = S(8) * std::numeric_limits<S>::epsilon() * (q.cwiseAbs().maxCoeff() + half_diagonal_);
    const auto center_limit_sq = [&] {  // for the centers of cells that may hold points within the limit
      const S far = S(1.001) * (std::sqrt(limit_sq) + half_diagonal_) + rounding;
      return far * far;
    };
    S last_sq = limit_sq, center_sq = center_limit_sq();
    tree_->approach(q, center_sq, [&](Index c, S) {
      const auto [begin, end] = at(runs_, c);
      f(begin, end);
      if (limit_sq != last_sq) last_sq = limit_sq, center_sq = center_limit_sq();
    });
    return std::isfinite(S(4) * center_sq);
  }

 private:
  const GridPoints<S>& grid_;
  S half_diagonal_;                                            // of a cell (m), rounded up
  std::vector<std::pair<std::uint32_t, std::uint32_t>> runs_;  // stored points of each occupied cell
  std::optional<KdTree<S>> tree_;
};

/// Finds the k nearest stored points by a CellTree. Each thread needs its own.
template <typename S>
class CellTreeNearest {
 public:
  CellTreeNearest(const CellTree<S>& cells, std::size_t k) : cells_(cells), k_(k) {}

  /// The k stored points nearest to q that are at most `radius` (m) away. Valid until the next call.
  const Neighborhood<S>& operator()(const Vector3<S>& q, S radius) {
    const GridPoints<S>& grid = cells_.grid();
    begin(radius);
    const auto try_cell = [&](std::size_t first, std::size_t last) { offer(q, first, last); };
    if (!cells_.approach(q, limit_sq_, try_cell)) {  // distances overflow: test all points
      begin(radius);
      offer(q, 0, grid.stored());
    }
    std::sort(found_.begin(), found_.end(), before());
    found_.resize(std::min(found_.size(), k_));
    distance_sq_.clear(), at_.clear();
    for (const Found& f : found_) distance_sq_.push_back(f.d_sq), at_.push_back(f.at);
    near_ = {at_.size(),      distance_sq_.data(), at_.data(), grid.x().data(),
             grid.y().data(), grid.z().data(),     nullptr,    grid.ids().data()};
    bound_by_last(near_);
    return near_;
  }

 private:
  struct Found {
    S d_sq;
    std::uint32_t at;  // position among the stored points
  };
  /// The order of found points: by distance, then by index in the cloud.
  auto before() const {
    return [ids = cells_.grid().ids().data()](const Found& a, const Found& b) {
      return a.d_sq < b.d_sq || (a.d_sq == b.d_sq && ids[a.at] < ids[b.at]);
    };
  }

  void begin(S radius) {
    found_.clear();
    limit_sq_ = radius * radius;
    capacity_ = k_;
  }
  /// Keeps those of the stored points [first, last) that may be among the k nearest.
  void offer(const Vector3<S>& q, std::size_t first, std::size_t last) {
    const GridPoints<S>& grid = cells_.grid();
    constexpr std::size_t kBlock = GridPoints<S>::kBlock;
    const auto distance_sq = distance_sq_from(q, grid.x().data(), grid.y().data(), grid.z().data());
    for (; first < last; first += kBlock) {
      S d_sq[kBlock];
      for (std::size_t l = 0; l < kBlock; ++l) d_sq[l] = distance_sq(first + l);  // the last block may exceed `last`
      unsigned near = 0;
      for (std::size_t l = 0; l < kBlock; ++l) near |= d_sq[l] <= limit_sq_ ? 1u : 0u;
      if (near == 0) continue;
      const std::size_t size = std::min(kBlock, last - first);
      for (std::size_t l = 0; l < size; ++l)
        if (d_sq[l] <= limit_sq_) keep(d_sq[l], first + l);
    }
  }
  /// Keeps a point. When as many points are kept as there is room for, all but the k nearest are dropped and the limit
  /// is lowered to the farthest of these.
  void keep(S d_sq, std::size_t j) {
    found_.push_back({d_sq, static_cast<std::uint32_t>(j)});
    if (found_.size() < capacity_) return;
    const auto last_of_k = found_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(found_.begin(), last_of_k, found_.end(), before());
    limit_sq_ = last_of_k->d_sq;
    found_.resize(k_);
    capacity_ = 2 * k_;
  }

  const CellTree<S>& cells_;
  std::size_t k_, capacity_ = 0;
  S limit_sq_ = 0;
  std::vector<Found> found_;
  std::vector<S> distance_sq_;
  std::vector<std::uint32_t> at_;
  Neighborhood<S> near_;
};

}  // namespace agrisee::detail
