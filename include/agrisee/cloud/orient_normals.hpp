// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Turns the normals of a cloud whose views are not known, so that they agree with one another: signs spread along a
/// minimum spanning tree of the neighbor graph, in which an edge costs 1 - |n_i . n_j| (Hoppe et al., SIGGRAPH 1992).
///
/// Where two bodies touch, or a leaf lies on one, their surfaces run side by side, and an edge between them would give
/// one of them the wrong sign. Where a surface bulges to one side, that side is its outside, and there the sign does
/// not come from neighbors. The rest takes it from the bulging places, along the tree.
///
/// Any frame; metres, radians. Cost: the k nearest neighbors of every point and a sort of the O(k n) edges; 16 k bytes
/// a point.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

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

/// To which side of the normals a point or a patch of points bulges.
struct Bulge {
  double value = 0.0;  ///< positive: the normals face outwards; negative: inwards
  bool known = false;  ///< whether that is clear

  /// Join another one, whose normals have this sign. Where it is clear, what is not clear does not count.
  void add(const Bulge& other, double sign) {
    if (known == other.known)
      value += sign * other.value;
    else if (other.known)
      value = sign * other.value;
    known = known || other.known;
  }
};

/// Disjoint patches of points. Each point knows whether its sign differs from that of its patch's first point.
class Patches {
 public:
  explicit Patches(std::vector<Bulge> points)
      : parent_(points.size()), flip_(points.size(), 0), bulges_(std::move(points)) {
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
  /// The bulge of a patch, given its first point.
  const Bulge& bulge(std::size_t root) const { return bulges_[root]; }

  /// Join the patches of a and b, unless the outsides of both are known.
  /// @param differ whether a and b have different signs
  void join(std::size_t a, std::size_t b, bool differ) {
    const std::size_t ra = root(a), rb = root(b);
    if (ra == rb || (bulges_[ra].known && bulges_[rb].known)) return;
    const bool flip = (differs(a) != differs(b)) != differ;
    const std::size_t first = std::min(ra, rb), second = std::max(ra, rb);
    parent_[second] = first;
    flip_[second] = flip ? 1 : 0;
    bulges_[first].add(bulges_[second], flip ? -1.0 : 1.0);
  }

 private:
  std::vector<std::size_t> parent_;
  std::vector<char> flip_;
  std::vector<Bulge> bulges_;  // at roots
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

/// How each known point's surroundings bulge: the correlation of the normals with the positions of its neighbors, 1 on
/// a sphere, 0.7 on a cylinder, 0 on a plane or a saddle, negative where the normals face inwards. What noise makes of
/// it is smoothed away among neighbors.
template <typename C, typename Known>
std::vector<Bulge> bulges(const std::vector<Vector3<scalar_t<C>>>& normals, const C& cloud,
                          const OrientationParameters& parameters, const NeighborLists& lists, int threads,
                          const Known& known) {
  using S = scalar_t<C>;
  constexpr double kClear = 0.25;
  constexpr int kRounds = 3;
  const std::size_t n = agrisee::size(cloud);
  const S cos_min = static_cast<S>(std::cos(parameters.max_angle));
  const S reach_sq = static_cast<S>(parameters.max_distance * parameters.max_distance);
  // f(j, p_j - p_i, differ) for the neighbors j on the surface of i; whether their normals have different signs
  const auto visit = [&](std::size_t i, auto&& f) {
    lists.visit(i, [&](Index index) {
      const auto j = static_cast<std::size_t>(index);
      if (j == i || !known(j)) return;
      const Vector3<S> apart = point(cloud, j) - point(cloud, i);
      const S cosine = normals[i].dot(normals[j]);
      if (apart.squaredNorm() <= reach_sq && std::abs(cosine) >= cos_min) f(j, apart, cosine < S(0));
    });
  };
  std::vector<double> now(n, 0.0), next(n, 0.0);
  throw_if_cancelled();
  parallel_for(n, threads, [&](std::size_t i) {
    if (!known(i)) return;
    double products = 0.0, distances = 0.0, changes = 0.0;
    visit(i, [&](std::size_t j, const Vector3<S>& apart, bool differ) {
      const Vector3<S> change = (differ ? Vector3<S>(-normals[j]) : normals[j]) - normals[i];
      products += double(apart.dot(change));
      distances += double(apart.squaredNorm());
      changes += double(change.squaredNorm());
    });
    if (distances > 0.0 && changes > 0.0) now[i] = products / std::sqrt(distances * changes);
  });
  for (int round = 0; round < kRounds; ++round) {
    throw_if_cancelled();
    parallel_for(n, threads, [&](std::size_t i) {
      if (!known(i)) return;
      double sum = now[i], count = 1.0;
      visit(i, [&](std::size_t j, const Vector3<S>&, bool differ) {
        sum += differ ? -now[j] : now[j];
        ++count;
      });
      next[i] = sum / count;
    });
    now.swap(next);
  }
  std::vector<Bulge> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = {now[i], std::abs(now[i]) > kClear};
  return out;
}

}  // namespace detail

/// The normals, turned so that they face outwards where the surface bulges, and neighbors agree elsewhere. A patch that
/// bulges nowhere (a plane) keeps the sign of its first point. Normals that are zero stay so.
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
  detail::Patches patches(detail::bulges(normals, cloud, parameters, lists, threads, known));
  for (const auto& e : edges) {  // Kruskal's algorithm: an edge inside a patch changes nothing
    if (((&e - edges.data()) & 0xFFFF) == 0) throw_if_cancelled();
    const auto a = static_cast<std::size_t>(e.a), b = static_cast<std::size_t>(e.b);
    patches.join(a, b, normals[a].dot(normals[b]) < 0);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!known(i)) continue;
    const bool inward = patches.bulge(patches.root(i)).value < -1e-6;
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
