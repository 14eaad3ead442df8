// SPDX-License-Identifier: BSD-3-Clause
// Both searches and all neighborhoods at once answer like all pairs, on clouds where every distance ties and on clouds
// that defy arithmetic.
#include <agrisee/neighbors/neighbor_lists.hpp>

#include "properties/laws.hpp"
#include "support/clouds.hpp"

using namespace agrisee;

namespace {

template <typename S, typename Search>
void check_search(const laws::Points<S>& cloud, const Search& search) {
  Neighbors<S> got;
  for (std::size_t i = 0; i < cloud.size(); i += 13) {
    const Vector3<S> q = cloud[i];
    if (!is_finite(q)) continue;
    auto all = shapes::brute<S>(cloud, q, std::numeric_limits<S>::infinity());
    for (const std::size_t k : {std::size_t(1), std::size_t(5), cloud.size()}) {
      search.knn(q, k, got);
      INFO("point " << i << ", k " << k);
      REQUIRE((got == Neighbors<S>(all.begin(), all.begin() + std::ptrdiff_t(std::min(k, all.size())))));
    }
    for (const S r : {S(0), S(0x1p-8), S(0.3), S(1e10)}) {
      INFO("point " << i << ", radius " << r);
      const auto expected = shapes::brute<S>(cloud, q, r * r);
      search.radius(q, r, got);
      REQUIRE((got == expected));
      REQUIRE(search.count(q, r) == expected.size());
    }
  }
}

}  // namespace

TEMPLATE_TEST_CASE("searches of exact and hostile clouds answer like all pairs", "", float, double) {
  using S = TestType;
  auto kinds = laws::hostile_kinds();
  for (const auto& kind : laws::exact_kinds()) kinds.push_back(kind);
  for (const auto& kind : kinds) {
    INFO(kind);
    const auto exact = laws::exact_cloud<S>(kind);
    const auto cloud = exact.empty() ? laws::hostile_cloud<S>(kind) : exact;
    check_search<S>(cloud, KdTree<S>(cloud));
    check_search<S>(cloud, Grid<S>(cloud, S(0x1p-8)));
    for (const std::size_t k : {std::size_t(1), std::size_t(7), cloud.size() + 1}) {
      const NeighborLists lists = nearest_neighbors(cloud, k, 2);
      for (std::size_t i = 0; i < cloud.size(); i += 17) {
        if (!is_finite(cloud[i])) continue;
        Indices got, expected;
        lists.visit(i, [&](Index j) { got.push_back(j); });
        for (const auto& n : shapes::brute<S>(cloud, cloud[i], std::numeric_limits<S>::infinity()))
          if (expected.size() < k) expected.push_back(n.index);
        INFO("point " << i << ", k " << k);
        REQUIRE((got == expected));
      }
    }
  }
}
