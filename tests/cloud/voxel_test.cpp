// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/voxel.hpp>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("voxels hold the mean of their points") {
  Cloud cloud;
  cloud.points = {{0.1f, 0.1f, 0.1f}, {0.3f, 0.1f, 0.1f}, {-0.1f, 0.1f, 0.1f}, {std::nanf(""), 0, 0}, {5, 5, 5}};
  std::vector<int> members;
  const Cloud thin = average_in_voxels(cloud, 1.0, &members);
  REQUIRE(thin.size() == 3);
  CHECK(thin.points[0].x() == Approx(-0.1f));
  CHECK(thin.points[1].x() == Approx(0.2f));
  CHECK(members == std::vector<int>{1, 2, 1});
  CHECK_THROWS_WITH(average_in_voxels(cloud, 0.0), "leaf must be positive and finite, got 0");
  CHECK_THROWS_WITH(average_in_voxels(cloud, 1e-310), "leaf must be so large that 1 / leaf is finite, got 1e-310");
  CHECK(average_in_voxels(Cloud{}, 1.0).empty());
}
