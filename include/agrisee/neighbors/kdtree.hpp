// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Neighbor search by a kd-tree, for k-nearest queries and radii of any size. This is the only file that uses
/// nanoflann. Building is O(n log n), a query O(log n + size of the answer).
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/detail/sums.hpp>
#include <agrisee/neighbors/neighbors.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nanoflann.hpp>

namespace agrisee {

/// A kd-tree over the finite points of a cloud; see neighbors.hpp for the interface. Distances are in metres.
template <typename S>
class KdTree {
 public:
  /// Copies the finite points of a cloud of any type (m).
  template <typename C>
  explicit KdTree(const C& cloud) : data_(std::make_unique<Data>()), size_(agrisee::size(cloud)) {
    data_->points.reserve(size_);
    for (std::size_t i = 0; i < size_; ++i) {
      const Vector3<S> p = point(cloud, i);
      if (is_finite(p)) {
        if (data_->points.size() != i || !data_->ids.empty()) {
          if (data_->ids.empty())
            for (std::size_t j = 0; j < data_->points.size(); ++j) data_->ids.push_back(static_cast<Index>(j));
          data_->ids.push_back(static_cast<Index>(i));
        }
        data_->points.push_back(p);
      }
    }
    index_ = std::make_unique<Tree>(3, *data_, nanoflann::KDTreeSingleIndexAdaptorParams(10));
#if NANOFLANN_VERSION < 0x150  // later versions build in the constructor
    index_->buildIndex();
#endif
  }

  /// Number of points of the cloud.
  std::size_t size() const { return size_; }

  /// Finds the k nearest points; see neighbors.hpp.
  void knn(const Vector3<S>& q, std::size_t k, Neighbors<S>& out) const {
    KnnResult result{detail::Nearest<S>(out, std::min(k, data_->points.size())), data_->ids};
    if (k > 0 && searchable(q)) {
      search(result, q);
      if (!std::isfinite(S(4) * result.nearest.worst_sq())) {  // the bounds of the tree may overflow: test all points
        out.clear();
        for (std::size_t i = 0; i < data_->points.size(); ++i) result.addPoint(distance_sq<S>(data_->points[i], q), i);
      }
    }
    result.nearest.finish();
  }

  /// Finds all points within r; see neighbors.hpp.
  void radius(const Vector3<S>& q, S r, Neighbors<S>& out) const { detail::sorted_radius(*this, q, r, out); }

  /// Counts the points within r; see neighbors.hpp.
  std::size_t count(const Vector3<S>& q, S r, std::size_t cap = kNoCap) const {
    if (!(r >= 0) || cap == 0 || !searchable(q)) return 0;
    CountResult result{r * r, 0, cap};
    search_within(result, q, r * r);
    return result.found;
  }

  /// Calls f(index, distance_sq) for all points within r; see neighbors.hpp.
  template <typename F>
  void visit(const Vector3<S>& q, S r, F&& f) const {
    const S r_sq = r * r;
    const auto inside = [&](Index i, S d_sq) {
      if (d_sq <= r_sq) f(i, d_sq);
    };
    if (!(r >= 0) || !searchable(q)) return;
    VisitResult<decltype(inside)> result{r_sq, inside, data_->ids};
    search_within(result, q, r_sq);
  }

  /// Calls f(i, distance_sq) for points i, those in near branches of the tree first. It misses no point whose squared
  /// distance is at most `limit_sq` (m2), provided that four times the final limit is finite. f may lower the limit in
  /// the meantime.
  template <typename F>
  void approach(const Vector3<S>& q, const S& limit_sq, F&& f) const {
    if (!searchable(q)) return;
    VisitResult<F> result{limit_sq, f, data_->ids};
    search(result, q);
  }

 private:
  struct Data {
    std::vector<Vector3<S>> points;
    std::vector<Index> ids;  // index in the cloud of each point; empty if equal to its position
    std::size_t kdtree_get_point_count() const { return points.size(); }
    S kdtree_get_pt(std::size_t i, std::size_t d) const { return points[i][static_cast<Eigen::Index>(d)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  /// nanoflann's metric, but with distances computed as in all searches, equal to the last bit.
  struct Metric : nanoflann::L2_Simple_Adaptor<S, Data> {
    explicit Metric(const Data& data) : nanoflann::L2_Simple_Adaptor<S, Data>(data), points(data.points) {}
    template <typename I>
    S evalMetric(const S* q, I i, std::size_t) const {
      const Vector3<S>& p = points[static_cast<std::size_t>(i)];
      return detail::sum_of_squares(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
    }
    const std::vector<Vector3<S>>& points;
  };
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Data, 3>;

  // nanoflann prunes branches by bounds with rounding errors. A slightly larger limit keeps points at exactly the
  // limit.
  static S padded(S d_sq) {
    return d_sq * (S(1) + S(64) * std::numeric_limits<S>::epsilon()) + std::numeric_limits<S>::min();
  }

  // "Result sets" as nanoflann calls them; since version 1.6 they must define the two types.
  using TreeIndex = std::uint32_t;
  struct KnnResult {
    using DistanceType = S;
    using IndexType = TreeIndex;
    detail::Nearest<S> nearest;
    const std::vector<Index>& ids;
    bool full() const { return nearest.full(); }
    S worstDist() const { return padded(nearest.worst_sq()); }
    std::size_t size() const { return 0; }
    bool empty() const { return false; }
    void sort() {}
    template <typename I>
    bool addPoint(S d_sq, I i) {
      nearest.offer(d_sq, ids.empty() ? static_cast<Index>(i) : ids[static_cast<std::size_t>(i)]);
      return true;
    }
  };
  struct CountResult {
    using DistanceType = S;
    using IndexType = TreeIndex;
    S r_sq;
    std::size_t found, cap;
    bool full() const { return true; }
    S worstDist() const { return padded(r_sq); }
    std::size_t size() const { return found; }
    bool empty() const { return found == 0; }
    void sort() {}
    template <typename I>
    bool addPoint(S d_sq, I) {
      if (d_sq <= r_sq) ++found;
      return found < cap;
    }
  };
  template <typename F>
  struct VisitResult {
    using DistanceType = S;
    using IndexType = TreeIndex;
    const S& limit_sq;
    F& f;
    const std::vector<Index>& ids;
    bool full() const { return true; }
    S worstDist() const { return padded(limit_sq); }
    std::size_t size() const { return 0; }
    bool empty() const { return false; }
    void sort() {}
    template <typename I>
    bool addPoint(S d_sq, I i) {
      f(ids.empty() ? static_cast<Index>(i) : ids[static_cast<std::size_t>(i)], d_sq);
      return true;
    }
  };

  /// Offers all points within sqrt(r_sq) (m) to the result.
  template <typename Result>
  void search_within(Result& result, const Vector3<S>& q, S r_sq) const {
    if (std::isfinite(S(4) * r_sq)) return search(result, q);
    for (std::size_t i = 0; i < data_->points.size(); ++i)  // the bounds of the tree may overflow
      if (!result.addPoint(distance_sq<S>(data_->points[i], q), i)) return;
  }

  bool searchable(const Vector3<S>& q) const { return !data_->points.empty() && is_finite(q); }

  template <typename Result>
  void search(Result& result, const Vector3<S>& q) const {
#if NANOFLANN_VERSION < 0x150
    index_->findNeighbors(result, q.data(), nanoflann::SearchParams());
#else
    index_->findNeighbors(result, q.data(), nanoflann::SearchParameters());
#endif
  }

  std::unique_ptr<Data> data_;  // pointers, because the tree refers to the data: so a KdTree can be moved
  std::unique_ptr<Tree> index_;
  std::size_t size_;
};

/// The scalar type of a tree is that of its cloud.
template <typename C>
KdTree(const C&) -> KdTree<scalar_t<C>>;

}  // namespace agrisee
