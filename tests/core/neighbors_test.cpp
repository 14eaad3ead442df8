// SPDX-License-Identifier: BSD-3-Clause
// Every neighbour query of every search equals brute force, ties and awkward clouds included.
#include <agrisee/core/grid.hpp>
#include <agrisee/core/kdtree.hpp>
#include <agrisee/core/random.hpp>

#include "catch.hpp"

using namespace agrisee;

namespace {

template <typename S>
using Points = std::vector<Vector3<S>>;

template <typename S>
Points<S> cloud_of(const std::string& kind, std::size_t n) {
  Rng rng(7);
  Points<S> p;
  const auto random = [&](double scale) {
    return Vector3<S>((Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform()) * scale).cast<S>());
  };
  if (kind == "random")
    for (std::size_t i = 0; i < n; ++i) p.push_back(random(0.3));
  if (kind == "gridded")
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y)
        for (int z = 0; z < 8; ++z) p.push_back(Vector3<S>(S(x), S(y), S(z)) * S(0.01));
  if (kind == "duplicated")
    for (std::size_t i = 0; i < n; ++i) p.push_back(i % 3 ? p[i - 1] : random(0.3));
  if (kind == "clustered")
    for (std::size_t i = 0; i < n; ++i)
      p.push_back(Vector3<S>(random(0.001) + Vector3<S>::Constant(S(i % 4) * S(10))));
  if (kind == "equal") p.assign(n, Vector3<S>(S(0.1), S(0.2), S(0.3)));
  if (kind == "line")
    for (std::size_t i = 0; i < n; ++i) p.push_back(Vector3<S>(S(i) * S(0.001), 0, 0));
  if (kind == "outliers") {
    for (std::size_t i = 0; i < n; ++i) p.push_back(random(0.3));
    p.push_back(Vector3<S>::Constant(S(1e6)));
    p.push_back(Vector3<S>::Constant(S(-1e5)));
  }
  if (kind == "nan") {
    for (std::size_t i = 0; i < n; ++i) p.push_back(random(0.3));
    p[3].x() = std::numeric_limits<S>::quiet_NaN();
    p[n / 2].y() = std::numeric_limits<S>::infinity();
  }
  if (kind == "one") p.push_back(Vector3<S>::Zero());
  return p;
}

template <typename S>
Neighbors<S> brute(const Points<S>& cloud, const Vector3<S>& q, S r_sq) {
  Neighbors<S> out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const S d_sq = distance_sq<S>(cloud[i], q);
    if (is_finite(cloud[i]) && d_sq <= r_sq) out.push_back({static_cast<Index>(i), d_sq});
  }
  std::sort(out.begin(), out.end(), detail::Nearest<S>::before);
  for (auto& n : out) n.distance = std::sqrt(n.distance);
  return out;
}

template <typename S, typename Search>
void check_search(const Points<S>& cloud, const Search& search, S r) {
  Rng rng(11);
  Points<S> queries;
  for (std::size_t i = 0; i < cloud.size(); i += std::max<std::size_t>(1, cloud.size() / 40)) queries.push_back(cloud[i]);
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
  check_search<S>(cloud, Grid<S>(cloud, S(3)), S(0.02));
}

}  // namespace

TEST_CASE("neighbour searches equal brute force") {
  const std::string kind =
      GENERATE(as<std::string>{}, "random", "gridded", "duplicated", "clustered", "equal", "line", "outliers", "nan", "one", "empty");
  INFO(kind);
  check_all<float>(kind);
  check_all<double>(kind);
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

TEST_CASE("a search refuses a cell size that is no size") {
  CHECK_THROWS_AS(Grid<float>(std::vector<Eigen::Vector3f>(3), 0.0f), ParameterError);
  CHECK_THROWS_AS(Grid<float>(std::vector<Eigen::Vector3f>(3), std::nanf("")), ParameterError);
}
