// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Normals of a cloud whose views are unknown, turned to agree with one another: signs spread along a minimum spanning
/// tree of the neighbourhood graph, an edge costing 1 - |n_i . n_j| (Hoppe et al., SIGGRAPH 1992).
///
/// Any frame, metres, radians. Cost: k nearest neighbours of every point and a sort of the O(k n) edges.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/kdtree.hpp>
#include <agrisee/core/parallel.hpp>

namespace agrisee {

/// Parameters of orient_normals_consistently.
struct OrientationParameters {
  int neighbors = 12;            ///< edges go from a point to this many nearest others
  double max_distance = 0.01;    ///< that are at most this far (m)
  double max_angle = deg(60.0);  ///< and whose normals, but for their sign, differ by at most this (rad): signs do not
                                 ///< spread across a crease, where they would be guesses

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    check_parameter(neighbors >= 1, "neighbors", "at least 1", neighbors);
    check_parameter(std::isfinite(max_distance) && max_distance > 0, "max_distance", "positive and finite",
                    max_distance);
    check_parameter(max_angle >= 0 && max_angle <= kPi / 2, "max_angle", "from 0 to pi/2", max_angle);
  }

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("neighbors", p.neighbors);
    f("max_distance", p.max_distance);
    f("max_angle", p.max_angle);
  }
};

namespace detail {

/// Disjoint sets whose members know whether their sign differs from that of the set's root.
class SignedSets {
 public:
  explicit SignedSets(std::size_t n) : parent_(n), flip_(n, 0) {
    for (std::size_t i = 0; i < n; ++i) parent_[i] = i;
  }
  /// Root of i; afterwards `differs(i)` is relative to it.
  std::size_t root(std::size_t i) {
    std::size_t top = i;
    char flip = 0;
    while (parent_[top] != top) {
      flip = static_cast<char>(flip ^ flip_[top]);
      top = parent_[top];
    }
    while (parent_[i] != top && i != top) {  // point the whole path at the root
      const std::size_t next = parent_[i];
      const char rest = static_cast<char>(flip ^ flip_[i]);
      parent_[i] = top;
      flip_[i] = flip;
      i = next;
      flip = rest;
    }
    return top;
  }
  bool differs(std::size_t i) const { return flip_[i] != 0; }
  /// Join the sets of a and b such that the signs of a and b differ or not.
  void join(std::size_t a, std::size_t b, bool differ) {
    const std::size_t ra = root(a), rb = root(b);
    if (ra == rb) return;
    const bool flip = differs(a) != differs(b) ? !differ : differ;
    parent_[std::max(ra, rb)] = std::min(ra, rb);
    flip_[std::max(ra, rb)] = flip ? 1 : 0;
  }

 private:
  std::vector<std::size_t> parent_;
  std::vector<char> flip_;
};

}  // namespace detail

/// The normals, turned so that neighbours agree and that each connected patch faces away from its own centroid:
/// outwards for whole bodies and for the convex caps that are seen of them. A patch that has no such side (a plane)
/// keeps the sign of its first point. Normals that are zero stay so.
/// @param search a KdTree or Grid over `cloud`
/// @throws ParameterError for a bad parameter, InputError when sizes disagree
template <typename C, typename Search>
std::vector<Vector3<scalar_t<C>>> orient_normals_consistently(std::vector<Vector3<scalar_t<C>>> normals, const C& cloud,
                                                              const OrientationParameters& params, const Search& search,
                                                              int threads = 1) {
  using S = scalar_t<C>;
  params.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(normals.size() == n && search.size() == n, "orienting normals needs one a point, and the cloud's search");
  const auto known = [&](std::size_t i) { return is_finite(point(cloud, i)) && normals[i].squaredNorm() > 0; };
  const S cos_min = static_cast<S>(std::cos(params.max_angle));

  struct Edge {
    S cost;
    Index a, b;
    bool operator<(const Edge& e) const { return cost != e.cost ? cost < e.cost : a != e.a ? a < e.a : b < e.b; }
  };
  const auto k = static_cast<std::size_t>(params.neighbors);
  std::vector<Edge> edges(n * k, Edge{S(2), 0, 0});  // a cost of 2 marks no edge
  parallel_chunks(n, threads, 512, [&](std::size_t begin, std::size_t end) {
    Neighbors<S> found;
    for (std::size_t i = begin; i < end; ++i) {
      if (!known(i)) continue;
      search.knn(point(cloud, i), k + 1, found);
      std::size_t next = i * k;
      for (const auto& neighbor : found) {
        const auto j = static_cast<std::size_t>(neighbor.index);
        if (j == i || next == (i + 1) * k || !known(j)) continue;
        const S cosine = std::abs(normals[i].dot(normals[j]));
        if (static_cast<double>(neighbor.distance) > params.max_distance || cosine < cos_min) continue;
        edges[next++] = {S(1) - cosine, static_cast<Index>(std::min(i, j)), static_cast<Index>(std::max(i, j))};
      }
    }
  });
  edges.erase(std::remove_if(edges.begin(), edges.end(), [](const Edge& e) { return e.cost == S(2); }), edges.end());
  std::sort(edges.begin(), edges.end());

  detail::SignedSets patches(n);  // Kruskal: an edge inside a patch changes nothing
  for (const Edge& e : edges) {
    const auto a = static_cast<std::size_t>(e.a), b = static_cast<std::size_t>(e.b);
    patches.join(a, b, normals[a].dot(normals[b]) < 0);
  }

  // Per patch, at its root (its first point): centroid, then how much the normals face away from it.
  std::vector<Eigen::Vector3d> centroid(n, Eigen::Vector3d::Zero());
  std::vector<double> count(n, 0.0), outward(n, 0.0), reach(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!known(i)) continue;
    const std::size_t r = patches.root(i);
    centroid[r] += point(cloud, i).template cast<double>();
    count[r] += 1.0;
  }
  const auto arm = [&](std::size_t i, std::size_t r) {
    return Eigen::Vector3d(point(cloud, i).template cast<double>() - centroid[r] / count[r]);
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (!known(i)) continue;
    const std::size_t r = patches.root(i);
    const double sign = patches.differs(i) ? -1.0 : 1.0;
    outward[r] += sign * arm(i, r).dot(normals[i].template cast<double>());
    reach[r] += arm(i, r).norm();
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!known(i)) continue;
    const std::size_t r = patches.root(i);
    const bool inward = outward[r] < -1e-6 * reach[r];
    if (patches.differs(i) != inward) normals[i] = -normals[i];
  }
  return normals;
}

/// The same with a search built for the call.
template <typename C>
std::vector<Vector3<scalar_t<C>>> orient_normals_consistently(std::vector<Vector3<scalar_t<C>>> normals, const C& cloud,
                                                              const OrientationParameters& params = {},
                                                              int threads = 1) {
  params.check();
  return orient_normals_consistently(std::move(normals), cloud, params, KdTree<scalar_t<C>>(cloud), threads);
}

}  // namespace agrisee
