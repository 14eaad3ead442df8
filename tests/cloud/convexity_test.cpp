// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/convexity.hpp>

#include <limits>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace {

Cloud ball(double radius, double spacing = 0.0024) {
  Cloud cloud;
  test::add_sphere(cloud, {{0.0, 0.5, 0.2}, radius}, spacing, [](const auto&) { return true; });
  return cloud;
}

std::optional<double> share(const Cloud& cloud) { return convex_share(cloud, 0.02, 0.05); }

}  // namespace

TEST_CASE("a ball bulges towards its normals, and inwards when they are turned") {
  Cloud cloud = ball(0.035);
  CHECK(share(cloud) == 1.0);
  for (auto& n : cloud.normals) n = -n;
  CHECK(share(cloud) == 0.0);
  Cloud half = ball(0.035);
  for (std::size_t i = 0; i < half.size(); ++i)
    if (half.points[i].x() < 0.0f) half.normals[i] = -half.normals[i];
  REQUIRE(share(half));
  CHECK(*share(half) == Approx(0.5).margin(0.05));
}

TEST_CASE("only what is curved as fruit are counts") {
  CHECK(share(ball(0.09)));
  CHECK_FALSE(share(ball(0.15, 0.004)));
  CHECK_FALSE(share(ball(0.008, 0.0008)));
  Cloud wall;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      wall.points.emplace_back(0.003f * static_cast<float>(i), 0.5f, 0.003f * static_cast<float>(j));
      wall.normals.emplace_back(0.0f, -1.0f, 0.0f);
    }
  CHECK_FALSE(share(wall));
}

TEST_CASE("clouds that say nothing of curvature") {
  CHECK_FALSE(share({}));
  CHECK_FALSE(share(ball(0.035, 0.02)));  // points too far apart
  Cloud same;
  same.points.assign(500, Eigen::Vector3f(0.1f, 0.2f, 0.3f));
  same.normals.assign(500, Eigen::Vector3f::UnitX());
  CHECK_FALSE(share(same));
  same.normals.assign(500, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  CHECK_FALSE(share(same));
  same.normals.clear();
  CHECK_THROWS_AS(share(same), InputError);
}
