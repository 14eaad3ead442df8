// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/voxel.hpp>

#include "catch.hpp"
#include "support/says.hpp"

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

TEST_CASE("voxels keep normals, but not what cannot be averaged") {
  Cloud cloud;
  cloud.points = {{0.1f, 0.1f, 0.1f}, {0.3f, 0.1f, 0.1f}, {5, 5, 5}};
  cloud.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  cloud.views = {0, 1, 1};
  cloud.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  cloud.instances = {0, 1, 2};
  const Cloud thin = average_in_voxels(cloud, 1.0);
  REQUIRE(thin.normals.size() == 2);
  CHECK(thin.normals[0].isApprox(Eigen::Vector3f(std::sqrt(0.5f), std::sqrt(0.5f), 0)));
  CHECK(thin.normals[1] == cloud.normals[2]);
  CHECK(thin.views.empty());
  CHECK(thin.colors.empty());
  CHECK(thin.instances.empty());

  cloud.normals.pop_back();
  CHECK_THROWS_WITH(average_in_voxels(cloud, 1.0), test::says("the cloud has 3 points, but 2 normals"));
  cloud.normals.clear();
  cloud.colors.pop_back();
  CHECK_THROWS_AS(average_in_voxels(cloud, 1.0), InputError);
}
