// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The k nearest points of one point as stages read them, picked from the candidates of a tile or by a search.
#pragma once

#include <agrisee/core/tiles.hpp>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace agrisee {

/// The neighbours of one point, nearest first, ties by index; itself included.
template <typename S>
struct Neighborhood {
  std::size_t size = 0;                   ///< number of neighbours
  const S* distance_sq = nullptr;         ///< m2
  const Index* ids = nullptr;             ///< in the cloud
  const S* x = nullptr;                   ///< x of neighbour i is x[at[i]] (m); may be the grid's own
  const S* y = nullptr;                   ///< y likewise
  const S* z = nullptr;                   ///< and z
  const std::uint32_t* at = nullptr;      ///< where neighbour i is among them
  const std::uint32_t* stored = nullptr;  ///< x[j] is the grid's point stored[j]; for those found in a tile

  /// Neighbour number i (m).
  Vector3<S> point(std::size_t i) const { return {x[at[i]], y[at[i]], z[at[i]]}; }
};

namespace detail {

/// Sorts the nearest of a tile's candidates; not to be shared between threads.
template <typename S>
class TileNearest {
 public:
  /// @param first_trial distance (m) within which k points are expected
  TileNearest(const Grid<S>& grid, std::size_t k, S first_trial)
      : grid_(grid), k_(k), trial_sq_(std::max(first_trial * first_trial, std::numeric_limits<S>::min())) {}

  /// The k candidates nearest to q that are at most `reach` away (m).
  const Neighborhood<S>& operator()(const Tile<S>& tile, const Vector3<S>& q, S reach) {
    resize(tile.size + kLanes);
    tile.distances_sq(q, all_.data());
    keep(tile.size, limit(tile.size, reach * reach));
    rank(tile);
    near_.size = std::min(k_, kept_);
    for (std::size_t i = 0; i < near_.size; ++i) ids_[i] = grid_.ids()[tile.at[at_[i]]];
    if (near_.size == k_ && sorted_[k_ - 1] > 0) trial_sq_ = S(1.3) * sorted_[k_ - 1];
    near_.distance_sq = sorted_.data(), near_.ids = ids_.data(), near_.at = at_.data();
    near_.x = tile.x.data(), near_.y = tile.y.data(), near_.z = tile.z.data(), near_.stored = tile.at.data();
    return near_;
  }

 private:
  static constexpr std::size_t kLanes = 8;

  void resize(std::size_t n) {
    if (all_.size() >= n) return;
    n *= 2;
    all_.resize(n), kept_sq_.resize(n), sorted_.resize(n);
    kept_at_.resize(n), at_.resize(n), ranks_.resize(n);
    ids_.resize(n);
  }

  std::size_t count(std::size_t n, S limit_sq) const {
    std::uint32_t in = 0;
    for (std::size_t j = 0; j < n; ++j) in += all_[j] <= limit_sq ? 1u : 0u;
    return in;
  }

  /// Keep those of n candidates whose squared distance is at most `limit_sq`.
  void keep(std::size_t n, S limit_sq) {
    const S* const all = all_.data();
    std::uint32_t* const at = kept_at_.data();
    std::size_t kept = 0;
    for (std::size_t j = 0; j < n; ++j) {  // no branch: a third of the candidates pass
      at[kept] = static_cast<std::uint32_t>(j);
      kept += all[j] <= limit_sq ? 1u : 0u;
    }
    for (std::size_t i = 0; i < kept; ++i) kept_sq_[i] = all[at[i]];
    kept_ = kept;
  }

  /// A squared distance, at most `reach_sq`, within which there are k of the n candidates, but few more.
  S limit(std::size_t n, S reach_sq) const {
    if (n <= k_) return reach_sq;
    S few = 0, enough = std::min(trial_sq_, reach_sq);  // squared distances within which there are too few, enough
    std::size_t in = count(n, enough);
    while (in < k_ && enough < reach_sq) {
      few = enough;
      enough = std::min(reach_sq, S(1.5) * enough * static_cast<S>(k_) / static_cast<S>(std::max(in, k_ / 4 + 1)));
      in = count(n, enough);
    }
    for (int trial = 0; trial < 12 && in > 2 * k_; ++trial) {  // counts grow with the square of the distance
      const S guess = few > 0 ? (few + enough) / S(2) : S(1.3) * enough * static_cast<S>(k_) / static_cast<S>(in);
      const std::size_t within = count(n, guess);
      if (within < k_)
        few = guess;
      else
        enough = guess, in = within;
    }
    return enough;
  }

  /// Sort what is kept, each to the place that the number of nearer ones gives it.
  void rank(const Tile<S>& tile) {
    const std::size_t n = kept_;
    if (n > std::min<std::size_t>(4 * k_ + 64, 384)) return sort(tile);
    for (std::size_t i = n; i < n + kLanes; ++i) kept_sq_[i] = std::numeric_limits<S>::infinity();
    std::size_t sum = 0;
    for (std::size_t i = 0; i < n; i += kLanes) {
      S own[kLanes];
      Rank nearer[kLanes] = {};
      std::copy_n(kept_sq_.data() + i, kLanes, own);
      for (std::size_t j = 0; j < n; ++j) {
        const S other = kept_sq_[j];
        for (std::size_t l = 0; l < kLanes; ++l) nearer[l] += other < own[l] ? Rank(1) : Rank(0);
      }
      std::copy_n(nearer, kLanes, ranks_.data() + i);
    }
    for (std::size_t i = 0; i < n; ++i) {
      sum += static_cast<std::size_t>(ranks_[i]);
      sorted_[static_cast<std::size_t>(ranks_[i])] = kept_sq_[i];
      at_[static_cast<std::size_t>(ranks_[i])] = kept_at_[i];
    }
    if (n > 0 && 2 * sum != n * (n - 1)) sort(tile);  // equal distances share a rank
  }

  /// Sort what is kept by distance, then by index.
  void sort(const Tile<S>& tile) {
    order_.clear();
    for (std::size_t i = 0; i < kept_; ++i)
      order_.push_back({{grid_.ids()[tile.at[kept_at_[i]]], kept_sq_[i]}, kept_at_[i]});
    std::sort(order_.begin(), order_.end(),
              [](const auto& a, const auto& b) { return Nearest<S>::before(a.first, b.first); });
    for (std::size_t i = 0; i < kept_; ++i) sorted_[i] = order_[i].first.distance, at_[i] = order_[i].second;
  }

  using Rank = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;  // as wide as S, for the vectors' sake

  const Grid<S>& grid_;
  std::size_t k_, kept_ = 0;
  S trial_sq_;  // > 0, that it can grow
  std::vector<S> all_, kept_sq_, sorted_;
  std::vector<std::uint32_t> kept_at_, at_;
  std::vector<Rank> ranks_;
  Indices ids_;
  std::vector<std::pair<Neighbor<S>, std::uint32_t>> order_;
  Neighborhood<S> near_;
};

/// The neighbourhood of a point by a search over the cloud; not to be shared between threads.
template <typename S>
class SearchNearest {
 public:
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
    near_ = {ids_.size(), distance_sq_.data(), ids_.data(), x_.data(), y_.data(), z_.data(), at_.data()};
    return near_;
  }

 private:
  Neighbors<S> found_;
  std::vector<S> distance_sq_, x_, y_, z_;
  Indices ids_;
  std::vector<std::uint32_t> at_;
  Neighborhood<S> near_;
};

}  // namespace detail

}  // namespace agrisee
