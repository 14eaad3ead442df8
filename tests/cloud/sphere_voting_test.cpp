// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/sphere_voting.hpp>

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
