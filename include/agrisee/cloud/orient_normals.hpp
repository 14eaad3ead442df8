// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Turns the normals of a cloud whose views are not known, so that they agree with one another: signs spread along a
/// minimum spanning tree of the neighbor graph, in which an edge costs 1 - |n_i . n_j| (Hoppe et al., SIGGRAPH 1992).
///
/// Where two bodies touch, their surfaces run side by side, and an edge between them would give one of them the wrong
/// sign. The outside of a curved patch is known: there its normals face away from its centroid. So an edge does not
/// join two patches if the outsides of both are known and disagree.
///
/// Any frame; metres, radians. Cost: the k nearest neighbors of every point and a sort of the O(k n) edges; 16 k bytes
/// a point.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

#include <cmath>

namespace agrisee {

/// Parameters of orient_normals_consistently.
struct OrientationParameters {
  int neighbors = 12;            ///< edges lead from a point to this many nearest others
  double max_distance = 0.01;    ///< edges are at most this long (m)
  double max_angle = deg(60.0);  ///< and join normals that, up to their sign, differ by at most this (rad): across a
                                 ///< crease signs would be guesses

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("neighbors", p.neighbors, Range::at_least(1));
    f("max_distance", p.max_distance, Range::positive());
    f("max_angle", p.max_angle, Range::between(0.0, {kPi / 2, "pi/2"}));
  }
};

namespace detail {

/// Sums over the points of a patch that tell whether its normals face away from its centroid.
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
  /// Whether it is clear which side is the outside.
  bool decided() const { return count >= 20.0 && std::abs(outwardness()) > 0.1; }
};

/// Disjoint patches of points. Each point knows whether its sign differs from that of its patch's first point.
class Patches {
 public:
  explicit Patches(std::vector<PatchSums> points) : parent_(points.size()), flip_(points.size(), 0), sums_(points) {
    for (std::size_t i = 0; i < parent_.size(); ++i) parent_[i] = i;
  }
  /// The first point of i's patch.
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
  /// Whether the sign of point i differs from that of its patch's first point; call root(i) before.
  bool differs(std::size_t i) const { return flip_[i] != 0; }
  /// The sums of a patch, given its first point.
  const PatchSums& sums(std::size_t root) const { return sums_[root]; }

  /// Join the patches of a and b, unless the outsides of both are known and one would be turned inside out.
  /// @param differ whether a and b have different signs
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

/// An edge of the neighbor graph; a < b.
template <typename S>
struct OrientationEdge {
  S cost;
  Index a, b;
  bool operator<(const OrientationEdge& e) const {
    return cost != e.cost ? cost < e.cost : a != e.a ? a < e.a : b < e.b;
  }
};

/// The edges of the neighbor graph, cheapest first.
/// @param known known(i) says whether point i is finite and has a normal
template <typename C, typename Known>
std::vector<OrientationEdge<scalar_t<C>>> orientation_edges(const std::vector<Vector3<scalar_t<C>>>& normals,
                                                            const C& cloud, const OrientationParameters& parameters,
                                                            const NeighborLists& lists, int threads,
                                                            const Known& known) {
  using S = scalar_t<C>;
  using Edge = OrientationEdge<S>;
  const std::size_t n = agrisee::size(cloud);
  const S cos_min = static_cast<S>(std::cos(parameters.max_angle));
  const auto k = std::min(static_cast<std::size_t>(parameters.neighbors), lists.k);
  const double reach_sq = parameters.max_distance * parameters.max_distance;
  // f(j) for the k nearest others of i.
  const auto others = [&](std::size_t i, auto&& f) {
    std::size_t left = k;
    lists.visit(i, [&](Index index) {
      const auto j = static_cast<std::size_t>(index);
      if (j != i && left > 0) --left, f(j);
    });
  };
  std::vector<Edge> edges;  // k a point; a cost of 2 marks those that are no edge
  edges.reserve(n * k);
  while (edges.size() < n * k) {  // part by part, so that it can be cancelled in between
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
      bool twice = false;  // an edge that both points list is entered for the smaller index
      if (j < i) others(j, [&](std::size_t l) { twice = twice || l == i; });
      if (!twice)
        edges[next++] = {S(1) - cosine, static_cast<Index>(std::min(i, j)), static_cast<Index>(std::max(i, j))};
    });
  });
  edges.erase(std::remove_if(edges.begin(), edges.end(), [](const Edge& e) { return e.cost == S(2); }), edges.end());
  sort_cancellably(edges.begin(), edges.end());
  return edges;
}

/// Every known point as a patch of its own.
template <typename C, typename Known>
std::vector<PatchSums> single_points(const std::vector<Vector3<scalar_t<C>>>& normals, const C& cloud,
                                     const Known& known) {
  const std::size_t n = agrisee::size(cloud);
  std::vector<PatchSums> points(n);
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // the first known point; sums about it lose fewer digits
  for (std::size_t i = n; i-- > 0;)
    if (known(i)) origin = point(cloud, i).template cast<double>();
  for (std::size_t i = 0; i < n; ++i) {
    if ((i & 0x3FFF) == 0) throw_if_cancelled();
    if (!known(i)) continue;
    const Eigen::Vector3d p = point(cloud, i).template cast<double>() - origin;
    const Eigen::Vector3d normal = normals[i].template cast<double>();
    points[i] = {1.0, p, normal, normal.dot(p), p.squaredNorm()};
  }
  return points;
}

}  // namespace detail

/// The normals, turned so that neighbors agree and that each connected patch faces away from its own centroid: outwards
/// for whole bodies and for the convex parts of them that are seen. A patch without such a side (a plane) keeps the
/// sign of its first point. Normals that are zero stay so.
/// @param normals one unit normal per point; zero if unknown
/// @param cloud points (m)
/// @param parameters see their struct
/// @param lists neighbor lists of `cloud`, of more than `parameters.neighbors` points as the point itself is one of
///   them; shorter ones are used as far as they reach
/// @param threads the result does not depend on it
/// @throws ParameterError for a bad parameter, InputError if sizes disagree
template <typename C>
std::vector<Vector3<scalar_t<C>>> orient_normals_consistently(std::vector<Vector3<scalar_t<C>>> normals, const C& cloud,
                                                              const OrientationParameters& parameters,
                                                              const NeighborLists& lists, int threads = 1) {
  parameters.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(normals.size() == n && lists.size() == n,
              "orienting normals needs one a point, and the cloud's neighbor lists");
  const auto known = [&](std::size_t i) { return is_finite(point(cloud, i)) && normals[i].squaredNorm() > 0; };
  const auto edges = detail::orientation_edges(normals, cloud, parameters, lists, threads, known);
  auto points = detail::single_points(normals, cloud, known);
  throw_if_cancelled();
  detail::Patches patches(std::move(points));
  for (const auto& e : edges) {  // Kruskal's algorithm: an edge inside a patch changes nothing
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

/// orient_normals_consistently with neighbor lists made for the call.
template <typename C>
std::vector<Vector3<scalar_t<C>>> orient_normals_consistently(std::vector<Vector3<scalar_t<C>>> normals, const C& cloud,
                                                              const OrientationParameters& parameters = {},
                                                              int threads = 1) {
  parameters.check();
  const NeighborLists lists = nearest_neighbors(cloud, static_cast<std::size_t>(parameters.neighbors) + 1, threads);
  return orient_normals_consistently(std::move(normals), cloud, parameters, lists, threads);
}

}  // namespace agrisee
