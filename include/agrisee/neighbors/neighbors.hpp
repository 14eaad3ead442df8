// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The interface of all neighbor searches. `KdTree` and `Grid` have the same functions and give identical answers:
///
/// - `knn(q, k, out)`      the k nearest points, nearest first (fewer if the cloud has fewer)
/// - `radius(q, r, out)`   all points with |p - q| <= r, nearest first
/// - `count(q, r, cap)`    the number of these points, but at most `cap`
/// - `visit(q, r, f)`      calls f(index, distance_sq) for each of these points, in no particular order
/// - `size()`              number of points of the cloud, including those that are not finite
///
/// Points at equal distances are ordered by index. The query point is not excluded: a point of the cloud finds itself
/// first. Points that are not finite are never found, and a query that is not finite finds nothing. A search copies the
/// coordinates, so it does not need the cloud after its construction.
#pragma once

#include <agrisee/core/detail/sums.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace agrisee {

/// A point that was found, and its distance from the query.
template <typename S>
struct Neighbor {
  Index index;  ///< in the cloud
  S distance;   ///< m
};

/// True if both the indices and the distances are equal.
template <typename S>
bool operator==(const Neighbor<S>& a, const Neighbor<S>& b) {
  return a.index == b.index && a.distance == b.distance;
}

/// The result of a search.
template <typename S>
using Neighbors = std::vector<Neighbor<S>>;

/// The `cap` of `count` that does not limit the count.
constexpr std::size_t kNoCap = std::numeric_limits<std::size_t>::max();

/// Squared distance (m2). All searches compute it in this one way, so that equal distances are equal everywhere.
template <typename S>
S distance_sq(const Vector3<S>& a, const Vector3<S>& b) {
  return detail::sum_of_squares(a.x() - b.x(), a.y() - b.y(), a.z() - b.z());
}

namespace detail {

/// Returns a function f(j): the squared distance (m2) from q to the point (x[j], y[j], z[j]). The result is that of
/// agrisee::distance_sq to the last bit. The arrays must outlive the function.
template <typename S>
auto distance_sq_from(const Vector3<S>& q, const S* x, const S* y, const S* z) {
  return [qx = q.x(), qy = q.y(), qz = q.z(), x, y, z](std::size_t j) {
    return sum_of_squares(x[j] - qx, y[j] - qy, z[j] - qz);
  };
}

/// The k nearest of the (squared distance, index) pairs that are offered, kept as a max-heap in `out`.
template <typename S>
class Nearest {
 public:
  Nearest(Neighbors<S>& out, std::size_t k) : heap_(out), k_(k) { heap_.clear(); }
  bool full() const { return heap_.size() == k_; }
  /// The largest squared distance (m2) that may still enter.
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
  /// Sorts the result, nearest first, and turns squared distances into distances.
  void finish() {
    std::sort_heap(heap_.begin(), heap_.end(), before);
    for (Neighbor<S>& n : heap_) n.distance = std::sqrt(n.distance);
  }
  /// The order of neighbors: by distance, then by index.
  static bool before(const Neighbor<S>& a, const Neighbor<S>& b) {
    return a.distance < b.distance || (a.distance == b.distance && a.index < b.index);
  }

 private:
  Neighbors<S>& heap_;
  std::size_t k_;
};

/// The function `radius` of a search, by means of its `visit`.
template <typename Search, typename S>
void sorted_radius(const Search& search, const Vector3<S>& q, S r, Neighbors<S>& out) {
  out.clear();
  search.visit(q, r, [&](Index i, S d_sq) { out.push_back({i, d_sq}); });
  std::sort(out.begin(), out.end(), Nearest<S>::before);
  for (Neighbor<S>& n : out) n.distance = std::sqrt(n.distance);
}

}  // namespace detail
}  // namespace agrisee
