// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Normals of a cloud whose views are unknown, turned to agree with one another: signs spread along a minimum spanning
/// tree of the neighbourhood graph, an edge costing 1 - |n_i . n_j| (Hoppe et al., SIGGRAPH 1992).
///
/// Where two bodies touch, their surfaces run side by side and an edge between them has the wrong sign. So an edge does
/// not join two patches of which both know their outside (normals face away from a curved patch's centroid) and
/// disagree.
///
/// Any frame, metres, radians. Cost: k nearest neighbours of every point and a sort of the O(k n) edges; 4 k + 12 k
/// bytes a point.
#pragma once

#include <agrisee/core/neighbor_lists.hpp>

#include <cmath>

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

/// Sums over the points of a patch from which it follows whether its normals face away from its centroid.
struct PatchSums {
  double count = 0.0;
  Eigen::Vector3d points = Eigen::Vector3d::Zero(), normals = Eigen::Vector3d::Zero();
  double flux = 0.0, squares = 0.0;  // sums of n . p and p . p

  void add(const PatchSums& other, double sign) {
    count += other.count;
    points += other.points;
    normals += sign * other.normals;
    flux += sign * other.flux;
    squares += other.squares;
  }
  /// Mean of n . (p - centroid) over the root mean square of |p - centroid|: 1 for a sphere, about 0.35 times the
  /// opening half-angle for a small cap of one, 0 for a plane, negative where the normals face inwards.
  double outwardness() const {
    const Eigen::Vector3d centroid = points / count;
    const double spread = std::sqrt(std::max(0.0, squares / count - centroid.squaredNorm()));
    return spread > 0.0 ? (flux - normals.dot(centroid)) / (count * spread) : 0.0;
  }
  /// Whether it is clear which side is outside.
  bool decided() const { return count >= 20.0 && std::abs(outwardness()) > 0.1; }
};

/// Disjoint patches of points, each of which knows whether its sign differs from that of the patch's first point.
class Patches {
 public:
  explicit Patches(std::vector<PatchSums> points) : parent_(points.size()), flip_(points.size(), 0), sums_(points) {
    for (std::size_t i = 0; i < parent_.size(); ++i) parent_[i] = i;
  }
  /// First point of i's patch; afterwards `differs(i)` is relative to it.
  std::size_t root(std::size_t i) {
    std::size_t top = i;
    char flip = 0;
    while (parent_[top] != top) {
      flip = static_cast<char>(flip ^ flip_[top]);
      top = parent_[top];
    }
    while (i != top) {  // point the whole path at the root
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
  const PatchSums& sums(std::size_t root) const { return sums_[root]; }

  /// Join the patches of a and b such that the signs of a and b differ or not; unless both know their outside and one
  /// of them would have to be turned inside out.
  void join(std::size_t a, std::size_t b, bool differ) {
    const std::size_t ra = root(a), rb = root(b);
    if (ra == rb) return;
    const bool flip = (differs(a) != differs(b)) != differ;
    const double sign = flip ? -1.0 : 1.0;
    if (sums_[ra].decided() && sums_[rb].decided() && sign * sums_[ra].outwardness() * sums_[rb].outwardness() < 0.0)
      return;
    const std::size_t first = std::min(ra, rb), second = std::max(ra, rb);
    parent_[second] = first;
    flip_[second] = flip ? 1 : 0;
    sums_[first].add(sums_[second], sign);
  }

 private:
  std::vector<std::size_t> parent_;
  std::vector<char> flip_;
  std::vector<PatchSums> sums_;  // at roots
};

}  // namespace detail

/// The normals, turned so that neighbours agree and that each connected patch faces away from its own centroid:
/// outwards for whole bodies and for the convex caps that are seen of them. A patch that has no such side (a plane)
/// keeps the sign of its first point. Normals that are zero stay so.
/// @param normals one per point, unit; zero where unknown
/// @param cloud points (m)
/// @param params see their struct
/// @param lists neighbour lists of `cloud` of more than `params.neighbors` points (the point itself is one of them);
///   shorter ones are used as far as they reach
/// @param threads the result does not depend on it
/// @throws ParameterError for a bad parameter, InputError when sizes disagree
template <typename C>
std::vector<Vector3<scalar_t<C>>> orient_normals_consistently(std::vector<Vector3<scalar_t<C>>> normals, const C& cloud,
                                                              const OrientationParameters& params,
                                                              const NeighborLists& lists, int threads = 1) {
  using S = scalar_t<C>;
  params.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(normals.size() == n && lists.size() == n,
              "orienting normals needs one a point, and the cloud's neighbours");
  const auto known = [&](std::size_t i) { return is_finite(point(cloud, i)) && normals[i].squaredNorm() > 0; };
  const S cos_min = static_cast<S>(std::cos(params.max_angle));

  struct Edge {
    S cost;
    Index a, b;
    bool operator<(const Edge& e) const { return cost != e.cost ? cost < e.cost : a != e.a ? a < e.a : b < e.b; }
  };
  const auto k = std::min(static_cast<std::size_t>(params.neighbors), lists.k);
  const double reach_sq = params.max_distance * params.max_distance;
  // f(j) for the k nearest others of i.
  const auto others = [&](std::size_t i, auto&& f) {
    std::size_t left = k;
    lists.visit(i, [&](Index index) {
      const auto j = static_cast<std::size_t>(index);
      if (j != i && left > 0) --left, f(j);
    });
  };
  std::vector<Edge> edges;  // a cost of 2 marks no edge
  edges.reserve(n * k);
  while (edges.size() < n * k) {  // many: by parts, to be stopped between them
    throw_if_cancelled();
    edges.resize(std::min(n * k, edges.size() + (std::size_t(1) << 18)), Edge{S(2), 0, 0});
  }
  parallel_for(n, threads, [&](std::size_t i) {
    if (!known(i)) return;
    std::size_t next = i * k;
    others(i, [&](std::size_t j) {
      if (!known(j)) return;
      const S cosine = std::abs(normals[i].dot(normals[j]));
      if (double(distance_sq<S>(point(cloud, i), point(cloud, j))) > reach_sq || cosine < cos_min) return;
      bool twice = false;  // what both list is the smaller index's edge
      if (j < i) others(j, [&](std::size_t l) { twice = twice || l == i; });
      if (!twice)
        edges[next++] = {S(1) - cosine, static_cast<Index>(std::min(i, j)), static_cast<Index>(std::max(i, j))};
    });
  });
  edges.erase(std::remove_if(edges.begin(), edges.end(), [](const Edge& e) { return e.cost == S(2); }), edges.end());
  detail::sort_cancellably(edges.begin(), edges.end());

  std::vector<detail::PatchSums> points(n);
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // among the points, for the sake of the digits
  for (std::size_t i = n; i-- > 0;)
    if (known(i)) origin = point(cloud, i).template cast<double>();
  for (std::size_t i = 0; i < n; ++i) {
    if ((i & 0x3FFF) == 0) throw_if_cancelled();
    if (!known(i)) continue;
    const Eigen::Vector3d p = point(cloud, i).template cast<double>() - origin;
    const Eigen::Vector3d normal = normals[i].template cast<double>();
    points[i] = {1.0, p, normal, normal.dot(p), p.squaredNorm()};
  }
  throw_if_cancelled();
  detail::Patches patches(std::move(points));
  for (const Edge& e : edges) {  // Kruskal: an edge inside a patch changes nothing
    if (((&e - edges.data()) & 0xFFFF) == 0) throw_if_cancelled();
    const auto a = static_cast<std::size_t>(e.a), b = static_cast<std::size_t>(e.b);
    patches.join(a, b, normals[a].dot(normals[b]) < 0);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!known(i)) continue;
    const bool inward = patches.sums(patches.root(i)).outwardness() < -1e-6;
    if (patches.differs(i) != inward) normals[i] = -normals[i];
  }
  return normals;
}

/// The same with lists made for the call.
template <typename C>
std::vector<Vector3<scalar_t<C>>> orient_normals_consistently(std::vector<Vector3<scalar_t<C>>> normals, const C& cloud,
                                                              const OrientationParameters& params = {},
                                                              int threads = 1) {
  params.check();
  const NeighborLists lists = nearest_neighbors(cloud, static_cast<std::size_t>(params.neighbors) + 1, threads);
  return orient_normals_consistently(std::move(normals), cloud, params, lists, threads);
}

}  // namespace agrisee
