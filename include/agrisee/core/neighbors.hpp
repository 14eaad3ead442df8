// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What every neighbour search answers. `KdTree` and `Grid` share one interface and give identical answers:
///
/// - `knn(q, k, out)`      the k nearest points, nearest first (fewer when the cloud is smaller)
/// - `radius(q, r, out)`   all points with |p - q| <= r, nearest first
/// - `count(q, r, cap)`    how many there are, at most `cap`
/// - `visit(q, r, f)`      f(index, distance_sq) for each of them, in no particular order
/// - `size()`              number of points of the cloud, those that are not finite included
///
/// Equal distances are ordered by index. The query point is not treated apart: a point of the cloud finds itself first.
/// Points that are not finite are never found; a query that is not finite finds nothing. A search copies the
/// coordinates, so the cloud may go away.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/sums.hpp>
#include <agrisee/core/types.hpp>

#include <algorithm>
#include <limits>

namespace agrisee {

/// A found point and its distance (m) from the query.
template <typename S>
struct Neighbor {
  Index index;  ///< in the cloud
  S distance;   ///< m
};

/// Equal in both.
template <typename S>
bool operator==(const Neighbor<S>& a, const Neighbor<S>& b) {
  return a.index == b.index && a.distance == b.distance;
}

/// What a search finds.
template <typename S>
using Neighbors = std::vector<Neighbor<S>>;

/// Count them all.
constexpr std::size_t kNoCap = std::numeric_limits<std::size_t>::max();

/// Squared distance, summed in the one way that all searches use, so that ties are ties everywhere.
template <typename S>
S distance_sq(const Vector3<S>& a, const Vector3<S>& b) {
  const S dx = a.x() - b.x(), dy = a.y() - b.y(), dz = a.z() - b.z();
  return detail::sum_of_squares(dx, dy, dz);
}

namespace detail {

/// The k best of the (distance_sq, index) pairs offered, kept as a max-heap.
template <typename S>
class Nearest {
 public:
  Nearest(Neighbors<S>& out, std::size_t k) : heap_(out), k_(k) { heap_.clear(); }
  bool full() const { return heap_.size() == k_; }
  /// Largest squared distance that can still enter.
  S worst_sq() const { return full() ? heap_.front().distance : std::numeric_limits<S>::infinity(); }
  void offer(S d_sq, Index i) {
    const Neighbor<S> n{i, d_sq};
    if (!full()) {
      heap_.push_back(n);
      std::push_heap(heap_.begin(), heap_.end(), before);
    } else if (before(n, heap_.front())) {
      std::pop_heap(heap_.begin(), heap_.end(), before);
      heap_.back() = n;
      std::push_heap(heap_.begin(), heap_.end(), before);
    }
  }
  /// Nearest first, squares to distances.
  void finish() {
    std::sort_heap(heap_.begin(), heap_.end(), before);
    for (Neighbor<S>& n : heap_) n.distance = std::sqrt(n.distance);
  }
  static bool before(const Neighbor<S>& a, const Neighbor<S>& b) {
    return a.distance < b.distance || (a.distance == b.distance && a.index < b.index);
  }

 private:
  Neighbors<S>& heap_;
  std::size_t k_;
};

}  // namespace detail
}  // namespace agrisee
