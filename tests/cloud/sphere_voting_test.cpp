// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/sphere_voting.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

TEST_CASE("votes of a part of a sphere meet at its center") {
  Cloud cloud;
  const Sphere truth{{0.2, -0.1, 0.4}, 0.037};
  test::add_sphere(
      cloud, truth, 0.003, [](const Eigen::Vector3d& d) { return d.x() > 0.6; }, 0.0003);
  const auto centers = vote_for_centers(cloud, 0.02, 0.05, 20);
  REQUIRE_FALSE(centers.empty());
  CHECK((centers[0].center - truth.center).norm() < 0.004);
  CHECK(vote_for_centers(Cloud{}, 0.02, 0.05, 20).empty());
  CHECK_THROWS_AS(vote_for_centers(cloud, 0.0, 0.05, 20), ParameterError);
  CHECK_THROWS_AS(vote_for_centers(cloud, 0.05, 0.02, 20), ParameterError);
}

TEST_CASE("new points tell where to look for centers") {
  Cloud cloud;
  const Sphere left{{-0.1, 0.0, 0.4}, 0.03}, right{{0.1, 0.0, 0.4}, 0.03};
  test::add_sphere(cloud, left, 0.003, test::everywhere);
  const std::size_t first = cloud.size();
  test::add_sphere(cloud, right, 0.003, test::everywhere);
  std::vector<char> fresh(cloud.size(), 0);
  CHECK(vote_for_centers(cloud, 0.02, 0.05, 100, fresh).empty());

  for (std::size_t i = first; i < cloud.size(); i += 4) fresh[i] = 1;
  const auto all = vote_for_centers(cloud, 0.02, 0.05, 100), near = vote_for_centers(cloud, 0.02, 0.05, 100, fresh);
  REQUIRE_FALSE(near.empty());
  CHECK((near[0].center - right.center).norm() < 0.002);
  for (const VotedCenter& c : near) CHECK(c.center.x() > 0.0);
  // Old points vote, too: there are as many votes as without the hint.
  const auto same = std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.center == near[0].center; });
  REQUIRE(same != all.end());
  CHECK(same->votes == near[0].votes);
  // A quarter of these votes are new: enough if they are half of the votes that a center needs.
  CHECK_FALSE(vote_for_centers(cloud, 0.02, 0.05, 0.4 * same->votes, fresh).empty());
  CHECK(vote_for_centers(cloud, 0.02, 0.05, 0.6 * same->votes, fresh).empty());

  std::fill(fresh.begin(), fresh.end(), char(1));
  CHECK(vote_for_centers(cloud, 0.02, 0.05, 100, fresh).size() == all.size());
  fresh.pop_back();
  CHECK_THROWS_AS(vote_for_centers(cloud, 0.02, 0.05, 100, fresh), InputError);
}

TEST_CASE("points whose normals are not of unit length do not vote") {
  Cloud cloud;
  test::add_sphere(cloud, {{0.2, -0.1, 0.4}, 0.037}, 0.003, [](const Eigen::Vector3d& d) { return d.x() > 0.6; });
  Cloud zeros = cloud;
  const std::array<float, 4> lengths = {0.0f, 3.0f, std::numeric_limits<float>::infinity(),
                                        std::numeric_limits<float>::quiet_NaN()};
  for (std::size_t i = 0; i < cloud.size(); i += 3) {
    zeros.normals[i].setZero();
    cloud.normals[i] *= lengths[i % lengths.size()];
  }
  const auto some = vote_for_centers(cloud, 0.02, 0.05, 20), same = vote_for_centers(zeros, 0.02, 0.05, 20);
  REQUIRE_FALSE(same.empty());
  REQUIRE(some.size() == same.size());
  for (std::size_t k = 0; k < some.size(); ++k) CHECK(some[k].center == same[k].center);
}

TEST_CASE("a grid of votes about no finite point is empty, and about one point holds all its votes") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Cloud cloud;
  cloud.points.assign(5, {nan, 0, 0});
  cloud.normals.assign(5, Eigen::Vector3f::UnitZ());
  const detail::VoteGrid none(cloud, 0.05, 0.004);
  CHECK(none.before == detail::VoteGrid::Cell::Zero());
  CHECK(none.origin == Eigen::Vector3d::Zero());
  CHECK(none.pitch == 0.004);
  CHECK(vote_for_centers(cloud, 0.02, 0.05, 1).empty());

  cloud.points[3] = {1.0f, 2.0f, 3.0f};
  const detail::VoteGrid one(cloud, 0.05, 0.004);
  CHECK(one.origin == Eigen::Vector3d(1, 2, 3));
  for (const std::uint64_t x : {0, 1, 7, 40})
    for (const std::uint64_t y : {0, 2, 41})
      for (const std::uint64_t z : {0, 3, 39})
        CHECK(one.unpack(one.pack(x, y, z)) ==
              detail::VoteGrid::Cell(std::int64_t(x), std::int64_t(y), std::int64_t(z)));
  const auto centers = vote_for_centers(cloud, 0.05, 0.05, 1);  // of one radius: the point votes once
  REQUIRE(centers.size() == 1);
  CHECK(centers[0].votes == 1.0);
  CHECK((centers[0].center - Eigen::Vector3d(1, 2, 2.95)).cwiseAbs().maxCoeff() <= 0.0051);  // half a cell of 10 mm
}

TEST_CASE("a point votes at each radius, from the smallest to the largest, a cell apart") {
  Cloud cloud;
  cloud.points.assign(1, {1.0f, 2.0f, 3.0f});
  cloud.normals.assign(1, Eigen::Vector3f::UnitZ());
  const auto any = [](auto) { return true; };
  const auto votes = [&](double radius_min, double radius_max) {
    const detail::VoteGrid grid(cloud, radius_max, 0.005);
    return detail::cast_votes(cloud, grid, radius_min, radius_max, any, any).size();
  };
  CHECK(votes(0.02, 0.05) == 7);
  CHECK(votes(0.02, 0.025) == 2);
  CHECK(votes(0.02, 0.02) == 1);
}

TEST_CASE("cells are found among the places, not before, between or after them") {
  Cloud cloud;
  test::add_sphere(cloud, {{0.2, -0.1, 0.4}, 0.03}, 0.003, test::everywhere);
  const detail::VoteGrid grid(cloud, 0.05, 0.004);
  const std::array<std::uint64_t, 4> added = {grid.pack(3, 2, 2), grid.pack(5, 2, 2), grid.pack(2, 4, 2),
                                              grid.pack(2, 2, 9)};
  detail::VotedPlaces places(grid);
  for (const std::uint64_t cell : added) places.add(cell);
  CHECK_FALSE(places.has(grid.pack(2, 2, 2)));
  for (const std::uint64_t cell : added) {
    CHECK(places.has(cell));
    CHECK(places.has(cell));  // the same once more
    CHECK(places.may_touch(cell));
    CHECK(places.may_touch(cell - grid.pack(1, 1, 1)));
    CHECK(places.may_touch(cell + grid.pack(1, 1, 1)));
    CHECK_FALSE(places.has(cell + 1));
  }
  CHECK_FALSE(places.has(grid.pack(9, 9, 9)));
  CHECK_FALSE(places.has(grid.pack(10, 9, 9)));
}

TEST_CASE("normals of about unit length vote, others do not") {
  const auto admits = [](float length) { return detail::VoteGrid::admits<float>(length * Eigen::Vector3f::UnitX()); };
  CHECK(admits(1.0f));
  CHECK(admits(0.72f));
  CHECK_FALSE(admits(0.70f));
  CHECK(admits(1.41f));
  CHECK_FALSE(admits(1.42f));
}

TEST_CASE("centers are thinned out to a distance, the first ones stay") {
  std::vector<detail::VoteSum> sums;
  for (const double x : {0.0, 0.9, 1.0, 1.9, 2.0}) sums.push_back({0, 9.0 - x, {x, 0, 0}});
  const auto thin = detail::thin_out(sums, 1.0, 400);
  REQUIRE(thin.size() == 3);
  CHECK(thin[0].votes == 9.0);
  CHECK(thin[1].center.x() == 1.0);
  CHECK(thin[2].center.x() == 2.0);
  sums.clear();
  for (int i = 0; i < 500; ++i) sums.push_back({0, 1.0, {2.0 * i, 0, 0}});
  CHECK(detail::thin_out(sums, 1.0, 400).size() == 400);
  CHECK(detail::thin_out(sums, 1.0, 450).size() == 450);
  CHECK(detail::thin_out(sums, 1.0, 1000).size() == 500);
  CHECK(detail::thin_out(sums, 1.0, 0).empty());
}

TEST_CASE("centers that are thinned out are those that comparing all with all leaves") {
  Rng rng(3);
  std::vector<detail::VoteSum> sums;
  for (int i = 0; i < 3000; ++i)  // a third of them on a lattice, whose steps are as long as centers stay apart
    sums.push_back({0, 1.0, {rng.uniform(0.0, 3.0), rng.uniform(0.0, 3.0), rng.uniform(-2.0, 1.0)}});
  for (std::size_t i = 0; i < sums.size(); i += 3) sums[i].center = 0.3 * (sums[i].center / 0.3).array().round();
  std::vector<Eigen::Vector3d> expected;
  for (const detail::VoteSum& s : sums)
    if (std::none_of(expected.begin(), expected.end(), [&](const auto& e) { return (e - s.center).norm() < 0.3; }))
      expected.push_back(s.center);
  const auto thin = detail::thin_out(sums, 0.3, 1000);
  REQUIRE(thin.size() == expected.size());
  CHECK(thin.size() > 400);
  for (std::size_t i = 0; i < thin.size(); ++i) CHECK(thin[i].center == expected[i]);
}

TEST_CASE("as many centers are voted for as are wanted, by default 400") {
  Cloud cloud;  // a face of each of 529 balls
  for (int i = 0; i < 529; ++i)
    test::add_sphere(cloud, {{0.1 * (i % 23), 0.1 * (i / 23), 0.0}, 0.03}, 0.006,
                     [](const auto& d) { return d.z() > 0.3; });
  CHECK(vote_for_centers(cloud, 0.025, 0.035, 10).size() == 400);
  CHECK(vote_for_centers(cloud, 0.025, 0.035, 10, {}, 450).size() == 450);
  const auto all = vote_for_centers(cloud, 0.025, 0.035, 10, {}, 10000);
  for (int i = 0; i < 529; ++i) {
    const Eigen::Vector3d center(0.1 * (i % 23), 0.1 * (i / 23), 0.0);
    CHECK(std::any_of(all.begin(), all.end(), [&](const auto& v) { return (v.center - center).norm() < 0.005; }));
  }
}
