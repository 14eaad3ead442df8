// SPDX-License-Identifier: BSD-3-Clause
// Every neighbor query of every search equals brute force, ties and awkward clouds included.
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include "catch.hpp"
#include "support/clouds.hpp"

using namespace agrisee;

namespace neighbors_test {

namespace {

using shapes::brute;
using shapes::cloud_of;
using shapes::Points;

template <typename S, typename Search>
void check_search(const Points<S>& cloud, const Search& search, S r) {
  Rng rng(11);
  Points<S> queries;
  for (std::size_t i = 0; i < cloud.size(); i += std::max<std::size_t>(1, cloud.size() / 40))
    queries.push_back(cloud[i]);
  for (int i = 0; i < 20; ++i)
    queries.push_back(Vector3<S>(Eigen::Vector3d(rng.uniform(-0.1, 0.4), rng.uniform(), rng.uniform()).cast<S>()));
  queries.push_back(Vector3<S>::Constant(S(50)));
  Neighbors<S> found;
  CHECK(search.size() == cloud.size());
  for (const auto& q : queries) {
    if (!is_finite(q)) continue;
    const auto all = brute<S>(cloud, q, std::numeric_limits<S>::infinity());
    for (const std::size_t k : {std::size_t(0), std::size_t(1), std::size_t(7), std::size_t(20), cloud.size() + 5}) {
      search.knn(q, k, found);
      REQUIRE(found == Neighbors<S>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(k, all.size()))));
    }
    for (const S radius : {S(0), r, S(3) * r}) {
      const auto expected = brute<S>(cloud, q, radius * radius);
      search.radius(q, radius, found);
      REQUIRE(found == expected);
      REQUIRE(search.count(q, radius) == expected.size());
      REQUIRE(search.count(q, radius, 5) == std::min<std::size_t>(expected.size(), 5));
    }
    CHECK(search.count(q, S(-1)) == 0);
  }
}

template <typename S>
void check_all(const std::string& kind) {
  const auto cloud = cloud_of<S>(kind, 600);
  check_search<S>(cloud, KdTree<S>(cloud), S(0.02));
  check_search<S>(cloud, Grid<S>(cloud, S(0.02)), S(0.02));
  check_search<S>(cloud, Grid<S>(cloud, S(0.005)), S(0.02));
  check_search<S>(cloud, Grid<S>(cloud, S(0.0005)), S(0.002));
  check_search<S>(cloud, Grid<S>(cloud, S(3)), S(0.02));
}

}  // namespace

TEST_CASE("neighbor searches equal brute force") {
  const std::string kind = GENERATE(from_range(shapes::cloud_kinds()));
  INFO(kind);
  check_all<float>(kind);
  check_all<double>(kind);
}

TEST_CASE("a kd-tree comes by all points within a limit, and by the nearest when the limit shrinks") {
  const auto cloud = cloud_of<float>("random", 3000);
  const KdTree<float> tree(cloud);
  for (std::size_t i = 0; i < cloud.size(); i += 97) {
    const Eigen::Vector3f q = cloud[i] + Eigen::Vector3f(0.01f, 0.0f, 0.002f);
    float limit_sq = 0.0009f;
    std::size_t within = 0, seen = 0;
    tree.approach(q, limit_sq, [&](Index, float d_sq) { within += d_sq <= limit_sq ? 1u : 0u; });
    CHECK(within == brute<float>(cloud, q, limit_sq).size());
    limit_sq = std::numeric_limits<float>::infinity();
    Index nearest = -1;
    tree.approach(q, limit_sq, [&](Index j, float d_sq) {
      ++seen;
      if (d_sq < limit_sq) limit_sq = d_sq, nearest = j;
    });
    CHECK(nearest == brute<float>(cloud, q, 1.0f).front().index);
    CHECK(seen < 300);
  }
}

TEST_CASE("searches take any cloud that meets the traits") {
  Eigen::Matrix3Xf columns = Eigen::Matrix3Xf::Random(3, 100);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 100; ++i) points.push_back(columns.col(i));
  const Eigen::Matrix<float, Eigen::Dynamic, 3> rows = columns.transpose();
  const Eigen::Map<const Eigen::Matrix3Xf> map(columns.data(), 3, 100);
  const Cloud own{points, {}, {}};
  Neighbors<float> a, b;
  KdTree(points).knn(points[5], 10, a);
  KdTree(columns).knn(points[5], 10, b);
  CHECK(a == b);
  KdTree(rows).knn(points[5], 10, b);
  CHECK(a == b);
  Grid(map, 0.5f).knn(points[5], 10, b);
  CHECK(a == b);
  Grid(own, 0.5f).knn(points[5], 10, b);
  CHECK(a == b);
}

TEST_CASE("a kd-tree finds all where its bounds overflow but the answer does not") {
  Rng rng(5);
  for (const double scale : {1e19, 2e19, 3e19}) {
    Points<float> cloud;
    for (int i = 0; i < 60; ++i)
      cloud.push_back((scale * Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform())).cast<float>());
    const KdTree<float> tree(cloud);
    Neighbors<float> found;
    for (const auto& q : cloud) {
      tree.knn(q, 7, found);
      auto expected = brute<float>(cloud, q, std::numeric_limits<float>::infinity());
      expected.resize(7);
      CHECK(found == expected);
      for (const float r : {1.5e19f, 1.8e19f, 2e19f}) {
        expected = brute<float>(cloud, q, r * r);
        CHECK(tree.count(q, r) == expected.size());
        CHECK(tree.count(q, r, 3) == std::min<std::size_t>(3, expected.size()));
        tree.radius(q, r, found);
        CHECK(found == expected);
      }
    }
  }
}

TEST_CASE("grids of next to no cells and of clouds as wide as numbers go") {
  const Points<double> equal(3000, {0.1, 0.2, 0.3});
  const Grid<double> tiny(equal, std::numeric_limits<double>::min());
  CHECK(tiny.count(equal[0], 0.0) == 3000);
  const Points<double> wide{{-1.5e308, 0, 0}, {0, 0, 0}, {1.5e308, 0, 0}};
  CHECK_THROWS_AS(Grid<double>(wide, 1.0), InputError);
  Points<float> line;  // far fewer points than cells, one of them no point
  for (int i = 0; i < 300; ++i) line.emplace_back(0.01f * static_cast<float>(i), 0.0f, 0.0f);
  line[7].x() = std::nanf("");
  line.emplace_back(1e3f, 1e3f, 1e3f);
  check_search<float>(line, Grid<float>(line, 0.01f), 0.02f);
}

TEST_CASE("a search refuses a cell size that is no size") {
  CHECK_THROWS_AS(Grid<float>(std::vector<Eigen::Vector3f>(3), 0.0f), ParameterError);
  CHECK_THROWS_AS(Grid<float>(std::vector<Eigen::Vector3f>(3), std::nanf("")), ParameterError);
}

}  // namespace neighbors_test
