// SPDX-License-Identifier: BSD-3-Clause
// Compiled for processors that multiply and add in one rounding: ties, of which lattices are full, are ties in every
// search, and neighbors of one another are so for both.
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// Points of a lattice `scale` (m) wide whose coordinates are rounded, some more than once, with a few that are astray.
template <typename S>
PointCloud<S> lattice(Rng& rng, std::size_t n, double scale) {
  PointCloud<S> cloud;
  const auto side = static_cast<std::uint64_t>(std::max(2.0, std::cbrt(static_cast<double>(n))));
  const double offset = rng.below(2) == 0 ? 0.0 : 1000.0 * scale;
  for (std::size_t i = 0; i < n; ++i) {
    Vector3<S> p;
    for (int a = 0; a < 3; ++a) p[a] = static_cast<S>(offset + scale * (static_cast<double>(rng.below(side)) / 3.0));
    if (rng.below(50) == 0) p *= S(1.37);
    cloud.points.push_back(p);
  }
  return cloud;
}

/// The lists by definition.
template <typename S>
NeighborLists lists_of(const PointCloud<S>& cloud, std::size_t k) {
  NeighborLists out{k, Indices(cloud.size() * k, -1)};
  std::vector<std::pair<S, Index>> all(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = 0; j < cloud.size(); ++j)
      all[j] = {distance_sq<S>(cloud.points[j], cloud.points[i]), static_cast<Index>(j)};
    const auto found = static_cast<std::ptrdiff_t>(std::min(k, all.size()));
    std::partial_sort(all.begin(), all.begin() + found, all.end());
    for (std::ptrdiff_t a = 0; a < found; ++a)
      out.ids[i * k + static_cast<std::size_t>(a)] = all[static_cast<std::size_t>(a)].second;
  }
  return out;
}

}  // namespace

TEMPLATE_TEST_CASE("ties are ties in every search, and regions those of explicit lists", "", float, double) {
  using S = TestType;
  Rng rng(7);
  for (int round = 0; round < 60; ++round) {
    const double scale = std::vector<double>{1.0, 1e-3, 1e3, sizeof(S) == 4 ? 1e18 : 1e150}[rng.below(4)];
    const PointCloud<S> cloud = lattice<S>(rng, 1 + rng.below(1500), scale);
    const std::size_t k = 1 + rng.below(12);
    INFO(round << ": " << cloud.size() << " points, k = " << k << ", scale " << scale);
    const NeighborLists lists = lists_of(cloud, k);
    CHECK(nearest_neighbors(cloud, k, 2).ids == lists.ids);
    const KdTree<S> tree(cloud);
    const Grid<S> grid(cloud, static_cast<S>(scale));
    Neighbors<S> near_tree, near_grid;
    bool same = true;
    for (const Vector3<S>& p : cloud.points) {
      tree.knn(p, k, near_tree);
      grid.knn(p, k, near_grid);
      const S r = near_tree.back().distance;
      same = same && near_tree == near_grid && tree.count(p, r) == grid.count(p, r);
    }
    CHECK(same);

    std::vector<Vector3<S>> normals;
    std::vector<S> curvatures;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      normals.push_back(Vector3<S>(static_cast<S>(rng.uniform(0.0, rng.below(2) == 0 ? 0.3 : 0.9)),
                                   static_cast<S>(rng.uniform(0.0, 0.3)), S(1))
                            .normalized());
      curvatures.push_back(static_cast<S>(0.01 * static_cast<double>(rng.below(5))));
    }
    RegionGrowingParameters p;
    p.neighbors = static_cast<int>(k);
    p.min_size = 1;
    p.smoothness = deg(rng.uniform(5.0, 35.0));
    const Labels expected = grow_regions(cloud, normals, p, lists, curvatures);
    CHECK(grow_regions(cloud, normals, p, curvatures, 1) == expected);
    CHECK(grow_regions(cloud, normals, p, curvatures, 2) == expected);
  }
}
