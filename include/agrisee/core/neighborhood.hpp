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

/// The neighbours of one point, itself included.
template <typename S>
struct Neighborhood {
  std::size_t size = 0;                   ///< number of neighbours
  const S* distance_sq = nullptr;         ///< m2, of each neighbour
  const std::uint32_t* at = nullptr;      ///< where neighbour i is among the points that follow
  const S* x = nullptr;                   ///< x of neighbour i is x[at[i]] (m); may be the grid's own
  const S* y = nullptr;                   ///< y likewise
  const S* z = nullptr;                   ///< and z
  const std::uint32_t* stored = nullptr;  ///< x[j] is the grid's point stored[j]; null where they are those of `ids`
  const Index* ids = nullptr;             ///< in the cloud; of the grid's stored points where `stored` is set
  /// Of all points, the neighbours are those whose squared distance (m2) is less than this, or equal to it with an
  /// index of at most `last`. It may be any number that tells them apart, not the same in each run.
  S last_sq = 0;
  Index last = 0;  ///< see last_sq

  /// Neighbour number i (m).
  Vector3<S> point(std::size_t i) const { return {x[at[i]], y[at[i]], z[at[i]]}; }
  /// Its index in the cloud.
  Index id(std::size_t i) const { return ids[stored ? stored[at[i]] : at[i]]; }
};

/// How the points of a neighbourhood come.
enum class Order {
  any,           ///< in some order, which depends on the cloud alone
  nearest_first  ///< by distance, then by index
};

namespace detail {

/// Picks the nearest of a tile's candidates; not to be shared between threads.
template <typename S, Order kOrder>
class TileNearest {
 public:
  /// @param first_trial distance (m) within which k points are expected
  TileNearest(const Grid<S>& grid, std::size_t k, S first_trial)
      : grid_(grid), k_(k), trial_sq_(std::max(first_trial * first_trial, std::numeric_limits<S>::min())) {}

  /// The k candidates nearest to q that are at most `reach` away (m).
  const Neighborhood<S>& operator()(const Tile<S>& tile, const Vector3<S>& q, S reach) {
    resize(tile.padded());
    tile.distances_sq(q, all_.data());
    near_.last_sq = limit(tile, reach * reach), near_.last = std::numeric_limits<Index>::max();
    keep(tile, near_.last_sq);
    if (kept_ > k_) cut(tile);
    if (kept_ == k_ && near_.last_sq > 0) trial_sq_ = S(1.1) * near_.last_sq;
    if constexpr (kOrder == Order::nearest_first) rank(tile);
    near_.size = kept_;
    near_.distance_sq = kept_sq_.data(), near_.at = kept_at_.data();
    near_.x = tile.x.data(), near_.y = tile.y.data(), near_.z = tile.z.data();
    near_.stored = tile.at.data(), near_.ids = grid_.ids().data();
    return near_;
  }

 private:
  static constexpr std::size_t kRows = 8;  // ranked at a time

  void resize(std::size_t n) {
    if (all_.size() >= n) return;
    n *= 2;
    all_.resize(n), kept_sq_.resize(n + kRows), sorted_.resize(n + kRows);
    kept_at_.resize(n), at_.resize(n), ranks_.resize(n);
  }

  /// How many candidates have a squared distance of at most `limit_sq`.
  std::size_t count(const Tile<S>& tile, S limit_sq) const {
    return tile.count_within([all = all_.data()](std::size_t j) { return all[j]; }, limit_sq);
  }

  /// Keep the candidates whose squared distance is at most `limit_sq`.
  void keep(const Tile<S>& tile, S limit_sq) {
    kept_ = tile.list_within(all_.data(), limit_sq, kept_at_.data());
    for (std::size_t i = 0; i < kept_; ++i) kept_sq_[i] = all_[kept_at_[i]];
  }

  /// A squared distance, at most `reach_sq`, within which there are k of the candidates; more where some are as far
  /// as the k-th or nearly so, fewer where there are no more within reach.
  S limit(const Tile<S>& tile, S reach_sq) const {
    if (tile.size <= k_) return reach_sq;
    S few = 0, enough = std::min(trial_sq_, reach_sq);  // squared distances within which there are too few, enough
    std::size_t under = 0, in = count(tile, enough);    // how many there are
    while (in < k_ && enough < reach_sq) {
      few = enough, under = in;
      enough = std::min(reach_sq, S(1.5) * enough * static_cast<S>(k_) / static_cast<S>(std::max(in, k_ / 4 + 1)));
      in = count(tile, enough);
    }
    for (int trial = 0; trial < 12 && in > k_; ++trial) {  // on a surface, counts grow with the square of the distance
      const S share = (static_cast<S>(k_ - under) + S(0.5)) / static_cast<S>(in - under);
      const S guess = few + share * (enough - few);
      if (!(few < guess && guess < enough)) break;
      const std::size_t within = count(tile, guess);
      if (within < k_)
        few = guess, under = within;
      else
        enough = guess, in = within;
    }
    return enough;
  }

  /// Of what is kept, keep the k nearest, ties by index.
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

  /// Sort what is kept, each to the place that the number of nearer ones gives it.
  void rank(const Tile<S>& tile) {
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
    if (n > 0 && 2 * sum != n * (n - 1)) return sort(tile);  // equal distances share a rank
    for (std::size_t i = 0; i < n; ++i) {
      sorted_[static_cast<std::size_t>(ranks_[i])] = kept_sq_[i];
      at_[static_cast<std::size_t>(ranks_[i])] = kept_at_[i];
    }
    std::swap(sorted_, kept_sq_), std::swap(at_, kept_at_);
  }

  /// Sort what is kept by distance, then by index.
  void sort(const Tile<S>& tile) {
    list(tile);
    std::sort(order_.begin(), order_.end(), before);
    for (std::size_t i = 0; i < kept_; ++i) kept_sq_[i] = order_[i].first.distance, kept_at_[i] = order_[i].second;
  }

  using Listed = std::pair<Neighbor<S>, std::uint32_t>;  // its distance is squared (m2); where it is in the tile
  static bool before(const Listed& a, const Listed& b) { return Nearest<S>::before(a.first, b.first); }
  void list(const Tile<S>& tile) {
    order_.clear();
    for (std::size_t i = 0; i < kept_; ++i)
      order_.push_back({{grid_.ids()[tile.at[kept_at_[i]]], kept_sq_[i]}, kept_at_[i]});
  }

  using Rank = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;  // as wide as S, for the vectors' sake

  const Grid<S>& grid_;
  std::size_t k_, kept_ = 0;
  S trial_sq_;  // > 0, that it can grow
  std::vector<S> all_, kept_sq_, sorted_;
  std::vector<std::uint32_t> kept_at_, at_;
  std::vector<Rank> ranks_;
  std::vector<Listed> order_;
  Neighborhood<S> near_;
};

/// Let a neighbourhood that is sorted end at its last one.
template <typename S>
void end_at_last(Neighborhood<S>& near) {
  if (near.size > 0) near.last_sq = near.distance_sq[near.size - 1], near.last = near.id(near.size - 1);
}

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
    near_ = {ids_.size(), distance_sq_.data(), at_.data(), x_.data(), y_.data(), z_.data(), nullptr, ids_.data()};
    end_at_last(near_);
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
