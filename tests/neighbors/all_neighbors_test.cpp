// SPDX-License-Identifier: BSD-3-Clause
// Neighborhoods, counts and components of all points at once equal brute force, on friendly and on awkward clouds.
#include <agrisee/neighbors/components.hpp>
#include <agrisee/neighbors/count_neighbors.hpp>
#include <agrisee/neighbors/neighbor_lists.hpp>

#include <cfenv>
#include <numeric>

#include "catch.hpp"
#include "support/clouds.hpp"

using namespace agrisee;

namespace {

template <typename S, Order kOrder>
void check_nearest_in(const shapes::Points<S>& cloud, std::size_t k, S radius) {
  std::vector<Neighbors<S>> found(cloud.size());
  std::vector<int> calls(cloud.size(), 0);
  for_each_neighborhood<kOrder>(cloud, k, radius, 2, [&](Index index, const Neighborhood<S>& near) {
    const auto i = static_cast<std::size_t>(index);
    ++calls[i];
    for (std::size_t j = 0; j < near.size; ++j) {
      found[i].push_back({near.id(j), std::sqrt(near.distance_sq[j])});
      if (near.point(j) != cloud[static_cast<std::size_t>(near.id(j))]) calls[i] += 100;
    }
    if (near.size < k) return;
    std::size_t up_to_last = 0;
    for (std::size_t j = 0; j < cloud.size(); ++j) {
      const S d_sq = distance_sq<S>(cloud[j], cloud[i]);
      up_to_last += d_sq < near.last_sq || (d_sq == near.last_sq && static_cast<Index>(j) <= near.last) ? 1u : 0u;
    }
    if (up_to_last != k) calls[i] += 1000;
  });
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    INFO("point " << i << ", k " << k << ", radius " << radius << ", sorted " << (kOrder == Order::nearest_first));
    REQUIRE(calls[i] == (is_finite(cloud[i]) ? 1 : 0));
    if (!is_finite(cloud[i])) continue;
    auto expected = shapes::brute<S>(cloud, cloud[i], radius * radius);
    if (expected.size() > k) expected.resize(k);
    if (kOrder == Order::any) {
      const auto by_index = [](const Neighbor<S>& a, const Neighbor<S>& b) { return a.index < b.index; };
      std::sort(found[i].begin(), found[i].end(), by_index);
      std::sort(expected.begin(), expected.end(), by_index);
    }
    REQUIRE(found[i] == expected);
  }
}

template <typename S>
void check_nearest(const shapes::Points<S>& cloud, std::size_t k, S radius) {
  check_nearest_in<S, Order::nearest_first>(cloud, k, radius);
  check_nearest_in<S, Order::any>(cloud, k, radius);
}

template <typename S>
void check_counts_and_components(const shapes::Points<S>& cloud, S r) {
  const auto counts = count_neighbors(cloud, r, 2);
  std::vector<Index> lowest(cloud.size());  // of the connected component, by spreading over brute-force neighbors
  std::iota(lowest.begin(), lowest.end(), Index(0));
  for (std::size_t seed = 0; seed < cloud.size(); ++seed) {
    if (!is_finite(cloud[seed])) {
      REQUIRE(counts[seed] == 0);
      continue;
    }
    REQUIRE(static_cast<std::size_t>(counts[seed]) == shapes::brute<S>(cloud, cloud[seed], r * r).size());
    if (lowest[seed] != static_cast<Index>(seed)) continue;
    Indices queue{static_cast<Index>(seed)};
    std::vector<char> seen(cloud.size(), 0);
    seen[seed] = 1;
    for (std::size_t head = 0; head < queue.size(); ++head)
      for (const auto& n : shapes::brute<S>(cloud, cloud[static_cast<std::size_t>(queue[head])], r * r))
        if (!seen[static_cast<std::size_t>(n.index)]) {
          seen[static_cast<std::size_t>(n.index)] = 1;
          lowest[static_cast<std::size_t>(n.index)] = static_cast<Index>(seed);
          queue.push_back(n.index);
        }
  }
  const CountingGrid<S> counting(cloud, r);
  const Grid<S>& grid = counting.grid;
  DisjointSets sets(grid.stored());
  join_neighbors(
      grid, counting.stencil, 2, sets, [](std::size_t) { return true; },
      [&](std::size_t j, std::size_t begin, std::size_t end, std::uint8_t* is) {
        for (std::size_t i = begin; i < end; ++i)
          is[i - begin] = distance_sq<S>(grid.stored_point(i), grid.stored_point(j)) <= r * r;
      });
  std::vector<Index> of_root(grid.stored(), -1);
  for (std::size_t j = 0; j < grid.stored(); ++j) {
    const Index component = lowest[static_cast<std::size_t>(grid.ids()[j])];
    Index& known = of_root[static_cast<std::size_t>(sets.root(static_cast<Index>(j)))];
    if (known < 0) known = component;
    REQUIRE(known == component);
  }
  std::vector<Index> roots;  // and no component has two roots
  for (const Index c : of_root)
    if (c >= 0) roots.push_back(c);
  std::sort(roots.begin(), roots.end());
  REQUIRE(std::adjacent_find(roots.begin(), roots.end()) == roots.end());
}

template <typename S>
void check_all(const std::string& kind) {
  const auto cloud = shapes::cloud_of<S>(kind, 300);
  for (const std::size_t k : {std::size_t(1), std::size_t(2), std::size_t(21), cloud.size() + 3})
    for (const S radius : {S(0), S(0.02), std::numeric_limits<S>::infinity()}) check_nearest<S>(cloud, k, radius);
  for (const S radius : {S(0), S(0.02), S(0.2)}) check_counts_and_components<S>(cloud, radius);
}

}  // namespace

TEST_CASE("neighbors whose squared distances overflow are taken in the order of their indices") {
  for (const double scale : {1e18, 6e18, 1e19, 3e19, 1e20, 4e20}) {
    Rng rng(11);
    shapes::Points<float> cloud;
    for (int i = 0; i < 400; ++i)
      cloud.push_back((scale * Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform())).cast<float>());
    for (const std::size_t k : {1u, 5u, 12u, 399u, 500u}) {
      INFO("scale " << scale);
      check_nearest<float>(cloud, k, std::numeric_limits<float>::infinity());
    }
  }
}

TEST_CASE("strays are found where the squares of cells nearly overflow") {
  const auto check = [](double cell, auto scalar) {
    using S = decltype(scalar);
    shapes::Points<S> cloud;
    const auto add = [&](double x, double y, double z) {
      cloud.push_back(Vector3<S>((Eigen::Vector3d(x, y, z) * cell).cast<S>()));
    };
    for (int i = 0; i < 40; ++i) add(0.8 * i, 0, 0);
    add(9.91555, 2.91555, 3.5);
    add(9.73777, 2.91555, 3.5);
    add(10.00444, 3.00444, 3.5);
    check_nearest<S>(cloud, 2, std::numeric_limits<S>::infinity());
  };
  check(2.25e19, 1.0f);
  check(2.25e154, 1.0);
}

TEST_CASE("neighbors at distances whose squares vanish or have few digits") {
  shapes::Points<float> cloud;
  for (int i = 0; i < 3000; ++i) cloud.emplace_back(i % 2 ? 1e-30f : 0.0f, 0.0f, 0.0f);  // two places, all squares 0
  check_nearest<float>(cloud, 5, std::numeric_limits<float>::infinity());
  Rng rng(2);
  for (const double scale : {3e-22, 1e-21, 1e-20}) {
    cloud.clear();
    for (int i = 0; i < 500; ++i)
      cloud.push_back((scale * Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform())).cast<float>());
    check_nearest<float>(cloud, 5, std::numeric_limits<float>::infinity());
  }
}

TEST_CASE("a radius means the same in a crowd as elsewhere") {
  const float radius = 0.0145148365f;  // the second point is farther by the last digit of its square
  shapes::Points<float> cloud{{0.0f, 0.0f, 0.0f}, {0.00614649896f, 0.0131491842f, 0.0f}};
  Rng rng(1);
  for (int i = 0; i < 1500; ++i) cloud.push_back((rng.direction() * 1.4 * double(radius)).cast<float>());
  for (int i = 0; i < 3000; ++i) cloud.emplace_back(5.0f * radius * static_cast<float>(i + 1), 0.0f, 0.0f);
  check_nearest<float>(cloud, 5, radius);
}

TEST_CASE("all neighborhoods at once equal brute force") {
  const std::string kind = GENERATE(from_range(shapes::cloud_kinds()));
  INFO(kind);
  check_all<float>(kind);
  check_all<double>(kind);
}

TEST_CASE("crowds are searched like other places") {
  // One in a hundred points is far from the others, so that cells are far too large for the rest.
  Rng rng(3);
  shapes::Points<float> cloud;
  for (int i = 0; i < 4000; ++i) {
    const double scale = i % 100 == 0 || i < 2100 ? 10.0 : 0.01;
    cloud.push_back((Eigen::Vector3d(rng.uniform(), rng.uniform(), 0.0) * scale).cast<float>());
  }
  check_nearest<float>(cloud, 5, std::numeric_limits<float>::infinity());
  // Missing points written as zeros; two places hold many, and one a few.
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (i % 3 == 0) cloud[i] = i % 2 == 0 ? Eigen::Vector3f::Zero() : Eigen::Vector3f(0.001f, 0.0f, 0.0f);
  cloud[1] = cloud[2] = cloud[7] = Eigen::Vector3f(0.002f, 0.0f, 0.0f);
  check_nearest<float>(cloud, 5, std::numeric_limits<float>::infinity());
  check_nearest<float>(cloud, 5, 0.0005f);
}

TEST_CASE("searches of finite clouds raise no flag of invalid arithmetic") {
  const auto cloud = shapes::cloud_of<float>("random", 300);
  std::feclearexcept(FE_ALL_EXCEPT);
  const NeighborLists lists = nearest_neighbors(cloud, 20);
  const std::vector<int> counts = count_neighbors(cloud, 0.02f);
  CHECK(std::fetestexcept(FE_INVALID) == 0);
  CHECK(lists.size() == counts.size());
}

TEMPLATE_TEST_CASE("indices within a limit are those of a plain loop", "", float, double) {
  Rng rng(5);
  for (const std::size_t n : {0u, 4u, 16u, 36u, 160u}) {
    std::vector<TestType> values(n);
    for (auto& v : values) v = rng.below(8) == 0 ? std::numeric_limits<TestType>::quiet_NaN() : TestType(rng.below(9));
    for (const TestType limit : {TestType(-1), TestType(4), std::numeric_limits<TestType>::infinity()}) {
      std::vector<std::uint32_t> expected, out(n);
      for (std::size_t i = 0; i < n; ++i)
        if (values[i] <= limit) expected.push_back(static_cast<std::uint32_t>(i));
      out.resize(detail::indices_within(values.data(), n, limit, out.data()));
      CHECK(out == expected);
    }
  }
}

TEST_CASE("a hundred thousand points at one place take no square of that") {
  const shapes::Points<float> cloud(100000, Eigen::Vector3f(0.1f, 0.2f, 0.3f));
  const Indices nearest = nearest_neighbors(cloud, 20).ids;
  CHECK(nearest[20 * 99999] == 0);
  CHECK(nearest.back() == 19);
  CHECK(count_neighbors(cloud, 0.01f)[7] == 100000);
}
