// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/spacing.hpp>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("the spacing of a cloud is the side of the square that a point stands for") {
  Cloud plane;
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 60; ++y)
      plane.points.emplace_back(0.002f * static_cast<float>(x), 0.002f * static_cast<float>(y), 0.0f);
  CHECK(estimate_spacing(plane) == Approx(0.002).epsilon(0.2));
  CHECK(estimate_spacing(Cloud{}) == 0.0);
  plane.points = {{0, 0, 0}, {1, 0, 0}, {1e30f, 0, 0}};  // its squared distances overflow
  CHECK(estimate_spacing(plane) == Approx(std::sqrt(kPi / 2.0)));
}
