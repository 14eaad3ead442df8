// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// DBSCAN (Ester et al., KDD 1996; paper, "Density-Based Spatial Clustering"): clusters of points with many neighbours.
///
/// Any frame, metres. Cost: a grid, one capped count a point and one visit of each core point's neighbours, O(n
/// neighbours) without storing any list; core points are joined by union-find, which gives the textbook algorithm's
/// answer.
///
/// A neighbour is a point at distance <= eps, as in all searches here (Open3D and PCL take < eps; the two differ on
/// exact ties only), and the point itself counts, as in Open3D.
#pragma once

#include <agrisee/core/grid.hpp>
#include <agrisee/core/parallel.hpp>

namespace agrisee {

/// Parameters of dbscan.
struct DbscanParameters {
  double eps = 0.007;   ///< radius of a neighbourhood (m)
  int min_points = 60;  ///< points, itself included, that make a point a core point

  /// The paper's values (table of parameters): eps = 7 mm, N_min = 60.
  static DbscanParameters paper() { return {}; }

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    check_parameter(std::isfinite(eps) && eps > 0, "eps", "positive and finite", eps);
    check_parameter(min_points >= 1, "min_points", "at least 1", min_points);
  }

  /// f(name, field) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("eps", p.eps);
    f("min_points", p.min_points);
  }
};

namespace detail {

/// Disjoint sets of indices; the smallest index of a set is its root.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) {
    for (std::size_t i = 0; i < n; ++i) parent_[i] = static_cast<Index>(i);
  }
  Index root(Index i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  /// Join the sets of two roots; the root of both.
  Index join(Index a, Index b) {
    if (a != b) parent(std::max(a, b)) = std::min(a, b);
    return std::min(a, b);
  }

 private:
  Index& parent(Index i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<Index> parent_;
};

}  // namespace detail

/// One label per point: clusters from 1 in the order of their first core points, 0 = noise. A border point belongs to
/// the first cluster that has a core point within eps of it. Points that are not finite are noise.
/// @param search a KdTree or Grid over `cloud`
/// @throws ParameterError for a bad parameter, InputError when the search is over a cloud of another size
template <typename C, typename Search>
Labels dbscan(const C& cloud, const DbscanParameters& params, const Search& search, int threads = 1) {
  using S = scalar_t<C>;
  params.check();
  const std::size_t n = agrisee::size(cloud);
  check_input(search.size() == n, "the search and the cloud differ in size");
  const S eps = static_cast<S>(params.eps);
  const auto needed = static_cast<std::size_t>(params.min_points);

  std::vector<char> core(n, 0);
  parallel_for(n, threads, [&](std::size_t i) { core[i] = search.count(point(cloud, i), eps, needed) >= needed; });

  detail::DisjointSets sets(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (!core[i]) continue;
    const auto self = static_cast<Index>(i);
    Index mine = sets.root(self);
    search.visit(point(cloud, i), eps, [&](Index j, S) {
      if (j < self && core[static_cast<std::size_t>(j)]) mine = sets.join(sets.root(j), mine);
    });
  }

  Labels labels(n, 0);
  int clusters = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!core[i]) continue;
    const auto root = static_cast<std::size_t>(sets.root(static_cast<Index>(i)));  // never after i
    labels[i] = root == i ? ++clusters : labels[root];
  }
  parallel_for(n, threads, [&](std::size_t i) {
    if (core[i]) return;
    int first = 0;
    search.visit(point(cloud, i), eps, [&](Index j, S) {
      const auto k = static_cast<std::size_t>(j);
      if (core[k] && (first == 0 || labels[k] < first)) first = labels[k];
    });
    labels[i] = first;
  });
  return labels;
}

/// The same with a search built for the call.
template <typename C>
Labels dbscan(const C& cloud, const DbscanParameters& params = {}, int threads = 1) {
  params.check();
  return dbscan(cloud, params, Grid<scalar_t<C>>(cloud, static_cast<scalar_t<C>>(params.eps)), threads);
}

}  // namespace agrisee
