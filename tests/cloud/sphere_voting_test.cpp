// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/sphere_voting.hpp>

#include <algorithm>
#include <array>
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
