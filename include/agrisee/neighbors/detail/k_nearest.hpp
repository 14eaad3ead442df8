// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds the k nearest points of one point as a Neighborhood: among the candidates of a tile, or by a search.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/neighbors/detail/tiles.hpp>
#include <agrisee/neighbors/neighborhood.hpp>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// Sets the bound of a sorted neighborhood to its last point.
template <typename S>
void bound_by_last(Neighborhood<S>& near) {
  if (near.size > 0) near.last_sq = near.distance_sq[near.size - 1], near.last = near.id(near.size - 1);
}

/// Selects the nearest of a tile's candidates. Each thread needs its own.
template <typename S, Order kOrder>
class TileNearest {
 public:
  /// @param grid whose points the tiles hold
  /// @param k number of neighbors, at least 1
  /// @param first_trial distance (m) within which k points are expected
  TileNearest(const GridPoints<S>& grid, std::size_t k, S first_trial)
      : grid_(grid), k_(k), trial_sq_(std::max(first_trial * first_trial, std::numeric_limits<S>::min())) {}

  /// The k candidates nearest to q that are at most `reach` (m) away. Valid until the next call.
  const Neighborhood<S>& operator()(const Tile<S>& tile, const Vector3<S>& q, S reach) {
    resize(tile.padded());
    tile.distances_sq(q, all_.data());
    near_.last_sq = limit(tile, reach * reach), near_.last = std::numeric_limits<Index>::max();
    keep(tile, near_.last_sq);
    if (kept_ > k_) cut(tile);
    if (kept_ == k_ && near_.last_sq > 0) trial_sq_ = S(1.1) * near_.last_sq;
    if constexpr (kOrder == Order::nearest_first) sort_by_rank(tile);
    near_.size = kept_;
    near_.distance_sq = kept_sq_.data(), near_.at = kept_at_.data();
    near_.x = tile.x.data(), near_.y = tile.y.data(), near_.z = tile.z.data();
    near_.stored = tile.at.data(), near_.ids = grid_.ids().data();
    return near_;
  }

 private:
  static constexpr std::size_t kRows = 8;  // number of points ranked at a time

  void resize(std::size_t n) {
    if (all_.size() >= n) return;
    n *= 2;
    all_.resize(n), kept_sq_.resize(n + kRows), sorted_sq_.resize(n + kRows);
    kept_at_.resize(n), sorted_at_.resize(n), ranks_.resize(n);
  }

  /// Number of candidates with a squared distance of at most `limit_sq` (m2).
  std::size_t count(const Tile<S>& tile, S limit_sq) const {
    return tile.count_within([all = all_.data()](std::size_t j) { return all[j]; }, limit_sq);
  }

  /// Keeps the candidates with a squared distance of at most `limit_sq` (m2).
  void keep(const Tile<S>& tile, S limit_sq) {
    kept_ = tile.list_within(all_.data(), limit_sq, kept_at_.data());
    for (std::size_t i = 0; i < kept_; ++i) kept_sq_[i] = all_[kept_at_[i]];
  }

  /// A squared distance (m2), at most `reach_sq`, that holds k candidates: possibly some more if several are about as
  /// far as the k-th, and fewer if there are no k within reach. Found by counting candidates and interpolating.
  S limit(const Tile<S>& tile, S reach_sq) const {
    if (tile.size <= k_) return reach_sq;
    S low = 0, high = std::min(trial_sq_, reach_sq);      // low holds fewer than k; high is to hold k or more
    std::size_t in_low = 0, in_high = count(tile, high);  // number of candidates within these
    while (in_high < k_ && high < reach_sq) {
      low = high, in_low = in_high;
      high = std::min(reach_sq, S(1.5) * high * static_cast<S>(k_) / static_cast<S>(std::max(in_high, k_ / 4 + 1)));
      in_high = count(tile, high);
    }
    // On a surface the number of points within a distance is proportional to its square: interpolate linearly.
    for (int trial = 0; trial < 12 && in_high > k_; ++trial) {
      const S share = (static_cast<S>(k_ - in_low) + S(0.5)) / static_cast<S>(in_high - in_low);
      const S guess = low + share * (high - low);
      if (!(low < guess && guess < high)) break;
      const std::size_t in_guess = count(tile, guess);
      if (in_guess < k_)
        low = guess, in_low = in_guess;
      else
        high = guess, in_high = in_guess;
    }
    return high;
  }

  /// Reduces the kept candidates to the k nearest; equal distances are ordered by index.
  void cut(const Tile<S>& tile) {
    list(tile);
    const auto kth = order_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(order_.begin(), kth, order_.end(), before);
    near_.last_sq = kth->first.distance, near_.last = kth->first.index;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < kept_; ++i) {
      const bool nearer = kept_sq_[i] < near_.last_sq ||
                          (kept_sq_[i] == near_.last_sq && grid_.ids()[tile.at[kept_at_[i]]] <= near_.last);
      kept_sq_[kept] = kept_sq_[i], kept_at_[kept] = kept_at_[i];
      kept += nearer ? 1u : 0u;
    }
    kept_ = kept;
  }

  /// Sorts the kept candidates. The rank of each is the number of nearer ones, which loops without branches count; that
  /// is faster than std::sort for up to some hundred candidates.
  void sort_by_rank(const Tile<S>& tile) {
    const std::size_t n = kept_;
    if (n > 384) return sort(tile);
    for (std::size_t i = n; i < n + kRows; ++i) kept_sq_[i] = std::numeric_limits<S>::infinity();
    std::size_t sum = 0;
    for (std::size_t i = 0; i < n; i += kRows) {
      S own[kRows];
      Rank nearer[kRows] = {};
      std::copy_n(kept_sq_.data() + i, kRows, own);
      for (std::size_t j = 0; j < n; ++j) {
        const S other = kept_sq_[j];
        for (std::size_t l = 0; l < kRows; ++l) nearer[l] += other < own[l] ? Rank(1) : Rank(0);
      }
      std::copy_n(nearer, kRows, ranks_.data() + i);
    }
    for (std::size_t i = 0; i < n; ++i) sum += static_cast<std::size_t>(ranks_[i]);
    if (n > 0 && 2 * sum != n * (n - 1)) return sort(tile);  // candidates at equal distances share a rank
    for (std::size_t i = 0; i < n; ++i) {
      sorted_sq_[static_cast<std::size_t>(ranks_[i])] = kept_sq_[i];
      sorted_at_[static_cast<std::size_t>(ranks_[i])] = kept_at_[i];
    }
    std::swap(sorted_sq_, kept_sq_), std::swap(sorted_at_, kept_at_);
  }

  /// Sorts the kept candidates by distance, then by index.
  void sort(const Tile<S>& tile) {
    list(tile);
    std::sort(order_.begin(), order_.end(), before);
    for (std::size_t i = 0; i < kept_; ++i) kept_sq_[i] = order_[i].first.distance, kept_at_[i] = order_[i].second;
  }

  /// A candidate with its squared distance (m2) and index in the cloud, and its position in the tile.
  using Listed = std::pair<Neighbor<S>, std::uint32_t>;
  static bool before(const Listed& a, const Listed& b) { return Nearest<S>::before(a.first, b.first); }
  /// Lists the kept candidates in `order_`.
  void list(const Tile<S>& tile) {
    order_.clear();
    for (std::size_t i = 0; i < kept_; ++i)
      order_.push_back({{grid_.ids()[tile.at[kept_at_[i]]], kept_sq_[i]}, kept_at_[i]});
  }

  using Rank = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;  // as wide as S, for vector instructions

  const GridPoints<S>& grid_;
  std::size_t k_, kept_ = 0;
  S trial_sq_;                                      // squared distance (m2) to try first, > 0
  std::vector<S> all_;                              // squared distances (m2) of all candidates
  std::vector<S> kept_sq_, sorted_sq_;              // of the kept ones
  std::vector<std::uint32_t> kept_at_, sorted_at_;  // their positions in the tile
  std::vector<Rank> ranks_;
  std::vector<Listed> order_;
  Neighborhood<S> near_;
};

/// Finds the k nearest points by a search over the cloud. Each thread needs its own.
template <typename S>
class SearchNearest {
 public:
  /// The k points of the cloud nearest to q that are at most `radius` (m) away. Valid until the next call.
  template <typename C, typename Search>
  const Neighborhood<S>& operator()(const C& cloud, const Search& search, const Vector3<S>& q, std::size_t k,
                                    S radius) {
    search.knn(q, k, found_);
    distance_sq_.clear(), x_.clear(), y_.clear(), z_.clear(), ids_.clear(), at_.clear();
    for (const Neighbor<S>& n : found_) {
      const Vector3<S> p = point(cloud, static_cast<std::size_t>(n.index));
      const S d_sq = distance_sq<S>(p, q);
      if (!(d_sq <= radius * radius)) break;
      at_.push_back(static_cast<std::uint32_t>(at_.size()));
      ids_.push_back(n.index);
      distance_sq_.push_back(d_sq);
      x_.push_back(p.x()), y_.push_back(p.y()), z_.push_back(p.z());
    }
    near_ = {ids_.size(), distance_sq_.data(), at_.data(), x_.data(), y_.data(), z_.data(), nullptr, ids_.data()};
    bound_by_last(near_);
    return near_;
  }

 private:
  Neighbors<S> found_;
  std::vector<S> distance_sq_, x_, y_, z_;
  Indices ids_;
  std::vector<std::uint32_t> at_;
  Neighborhood<S> near_;
};

}  // namespace agrisee::detail
