// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The k nearest points within a radius, for one point of a cloud after another. Each query first tries the radius that
/// held k points at the query before, since density changes little from point to point: a dense neighbourhood is not
/// read whole, and nothing is sorted. Exact; metres, any frame. Cost about 1.5 k points read a query.
#pragma once

#include <agrisee/core/neighbors.hpp>

#include <cmath>

namespace agrisee {

/// Not to be shared between threads: it remembers the last query.
template <typename S>
class HybridQuery {
 public:
  /// @param radius neighbours are at most this far (m), > 0
  /// @param k at most this many, the nearest (ties by index), the query point itself included, > 0
  HybridQuery(S radius, std::size_t k) : radius_(radius), k_(k), trial_(radius) {}

  /// Neighbours of q in no particular order; their `distance` is squared. A query that is not finite has none.
  /// @param search a KdTree or Grid
  template <typename Search>
  const Neighbors<S>& operator()(const Search& search, const Vector3<S>& q) {
    gather(search, q, trial_);
    if (found_.size() < k_ && trial_ < radius_) gather(search, q, radius_);
    if (found_.size() > k_) {
      const auto last = found_.begin() + static_cast<std::ptrdiff_t>(k_) - 1;
      std::nth_element(found_.begin(), last, found_.end(), detail::Nearest<S>::before);
      found_.resize(k_);
    }
    trial_ = radius_;
    if (found_.size() == k_) {
      S worst_sq = 0;
      for (const auto& n : found_) worst_sq = std::max(worst_sq, n.distance);
      trial_ = std::min(radius_, S(1.25) * std::sqrt(worst_sq));
    }
    return found_;
  }

 private:
  template <typename Search>
  void gather(const Search& search, const Vector3<S>& q, S r) {
    found_.clear();
    search.visit(q, r, [&](Index i, S d_sq) { found_.push_back({i, d_sq}); });
  }

  S radius_;
  std::size_t k_;
  S trial_;
  Neighbors<S> found_;
};

}  // namespace agrisee
