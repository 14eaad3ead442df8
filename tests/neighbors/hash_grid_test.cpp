// SPDX-License-Identifier: BSD-3-Clause
// The growing grid answers as brute force does, after every insertion, on awkward clouds and for all radii.
#include <agrisee/neighbors/hash_grid.hpp>

#include "catch.hpp"

using namespace agrisee;

TEMPLATE_TEST_CASE("hash grid equals brute force", "[hash_grid]", float, double) {
  using S = TestType;
  const int kind = GENERATE(0, 1, 2, 3, 4, 5);
  CAPTURE(kind);
  Rng rng(5, static_cast<std::uint64_t>(kind));
  std::vector<Vector3<S>> cloud;
  HashGrid<S> grid(S(0.01));
  for (int i = 0; i < 700; ++i) {
    Vector3<S> p = (Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform()) * 0.1).cast<S>();
    if (kind == 1) p = Vector3<S>(S(i % 9), S(i / 9 % 9), S(i / 81)) * S(0.005);          // lattice
    if (kind == 2) p = Vector3<S>::Constant(S(0.3));                                      // all equal
    if (kind == 3) p = Vector3<S>(S(0.001) * S(i), 0, 0);                                 // a line
    if (kind == 4 && i % 10 == 0) p = Vector3<S>::Constant(S(i % 20 == 0 ? 1e9 : -1e6));  // far beyond the limit
    if (kind == 5 && i % 10 == 0) p.y() = std::numeric_limits<S>::quiet_NaN();
    cloud.push_back(p);
    REQUIRE(grid.insert(p) == static_cast<Index>(i));
    if (i % 7 != 0) continue;
    const Vector3<S> q = i % 2 ? p : Vector3<S>(p + Vector3<S>::Constant(S(0.004)));
    const S r = std::vector<S>{0, S(0.002), S(0.005), S(0.012), S(0.05), S(3)}[std::size_t(i / 7 % 6)];
    Neighbors<S> expected, got;
    bool nearer = false;
    for (std::size_t j = 0; j < cloud.size() && is_finite(q); ++j) {
      if (!is_finite(cloud[j])) continue;
      const S d_sq = distance_sq<S>(cloud[j], q);
      if (d_sq <= r * r) expected.push_back({static_cast<Index>(j), d_sq});
      nearer = nearer || d_sq < r * r;
    }
    std::sort(expected.begin(), expected.end(), detail::Nearest<S>::before);
    for (auto& n : expected) n.distance = std::sqrt(n.distance);
    grid.radius(q, r, got);
    REQUIRE(got == expected);
    REQUIRE(grid.count(q, r) == expected.size());
    REQUIRE(grid.count(q, r, 3) == std::min<std::size_t>(3, expected.size()));
    REQUIRE(grid.nearer(q, r) == nearer);
  }
  REQUIRE(grid.size() == cloud.size());
}

TEST_CASE("hash grid, bad input", "[hash_grid]") {
  for (const float cell :
       {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    REQUIRE_THROWS_AS(HashGrid<float>(cell), ParameterError);
  HashGrid<float> grid(1.0f);
  REQUIRE(grid.count(Eigen::Vector3f::Zero(), 1.0f) == 0);
  grid.insert(Eigen::Vector3f::Zero());
  REQUIRE(grid.count(Eigen::Vector3f::Zero(), -1.0f) == 0);
  REQUIRE(grid.count(Eigen::Vector3f::Constant(std::nanf("")), 1.0f) == 0);
  REQUIRE(grid.count(Eigen::Vector3f::Zero(), 1.0f, 0) == 0);
  REQUIRE_FALSE(grid.nearer(Eigen::Vector3f::UnitX(), 1.0f));  // strictly
}

TEST_CASE("cell table keeps the last value of every cell", "[hash_grid]") {
  CellTable table;
  REQUIRE(table.find({0, 0, 0}) == -1);
  const std::int32_t far = CellTable::kLimit;
  const std::vector<CellIndex> cells{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {far, far, far}, {-far, -far, -far}};
  for (std::size_t i = 0; i < cells.size(); ++i) REQUIRE(table.exchange(cells[i], static_cast<Index>(i)) == -1);
  for (std::int32_t i = 0; i < 1000; ++i) table.exchange({i, 7, -i}, i);
  for (std::size_t i = 0; i < cells.size(); ++i) REQUIRE(table.find(cells[i]) == static_cast<Index>(i));
  REQUIRE(table.exchange({0, 0, 0}, 9) == 0);
  REQUIRE(table.find({0, 0, 0}) == 9);
  REQUIRE(table.size() == cells.size() + 1000);
}
