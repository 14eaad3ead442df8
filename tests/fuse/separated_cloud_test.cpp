// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/random.hpp>
#include <agrisee/fuse/separated_cloud.hpp>

#include "catch.hpp"

using namespace agrisee;
using Eigen::Vector3f;
using fuse::SeparatedCloud;

TEST_CASE("merging by minimum separation keeps the first point of a place") {
  SeparatedCloud merged(0.25);
  CHECK(merged.cloud().empty());
  CHECK(merged.add({0, 0, 0}, 0));
  CHECK_FALSE(merged.add({0.249f, 0, 0}, 1));
  CHECK_FALSE(merged.add({0, 0, 0}, 1));
  CHECK(merged.add({0.25f, 0, 0}, 2));  // not nearer than the separation
  CHECK(merged.add({0, 0, -0.3f}, 2));
  CHECK(merged.cloud().points == std::vector<Vector3f>{{0, 0, 0}, {0.25f, 0, 0}, {0, 0, -0.3f}});
  CHECK(merged.cloud().views == std::vector<int>{0, 2, 2});
  CHECK(merged.cloud().normals.empty());
}

TEST_CASE("points that are not finite are not merged") {
  SeparatedCloud merged(0.01);
  CHECK_FALSE(merged.add({std::nanf(""), 0, 0}, 0));
  CHECK_FALSE(merged.add({0, -std::numeric_limits<float>::infinity(), 0}, 0));
  CHECK(merged.cloud().empty());
}

TEST_CASE("the place of a dropped point is free again, that of a kept one is not") {
  SeparatedCloud merged(0.01);
  for (int i = 0; i < 4; ++i) CHECK(merged.add({0.02f * static_cast<float>(i), 0, 0}, i));
  merged.keep({1, 3});
  CHECK(merged.cloud().points == std::vector<Vector3f>{{0.02f, 0, 0}, {0.06f, 0, 0}});
  CHECK(merged.cloud().views == std::vector<int>{1, 3});
  CHECK_FALSE(merged.add({0.021f, 0, 0}, 5));
  CHECK_FALSE(merged.add({0.061f, 0, 0}, 5));
  CHECK(merged.add({0.001f, 0, 0}, 6));
  CHECK(merged.add({0.041f, 0, 0}, 7));
  CHECK(merged.cloud().views == std::vector<int>{1, 3, 6, 7});
  merged.keep({});
  CHECK(merged.cloud().empty());
  CHECK(merged.add({0.021f, 0, 0}, 8));
}

TEST_CASE("merging by minimum separation equals brute force") {
  const float separation = 0.02f;
  SeparatedCloud merged(0.02);
  std::vector<Vector3f> expected;
  Rng rng(11);
  for (int i = 0; i < 2000; ++i) {
    const Vector3f p =
        Eigen::Vector3d(rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.02, 0.02)).cast<float>();
    bool free = true;
    for (const Vector3f& q : expected) free = free && !((q - p).squaredNorm() < separation * separation);
    if (free) expected.push_back(p);
    REQUIRE(merged.add(p, 0) == free);
  }
  CHECK(merged.cloud().points == expected);
  CHECK(expected.size() > 100);
}

TEST_CASE("merging refuses a separation that is not positive") {
  CHECK_THROWS_AS(SeparatedCloud(0.0), ParameterError);
  CHECK_THROWS_AS(SeparatedCloud(-0.01), ParameterError);
  CHECK_THROWS_AS(SeparatedCloud(std::nan("")), ParameterError);
}
