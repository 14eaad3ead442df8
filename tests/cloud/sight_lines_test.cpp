// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/sight_lines.hpp>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// A wall of points 2 mm apart at y = 0.5 m, seen from the origin.
Cloud wall() {
  Cloud cloud;
  for (int i = -50; i <= 50; ++i)
    for (int j = -50; j <= 50; ++j) cloud.points.emplace_back(0.002f * float(i), 0.5f, 0.002f * float(j));
  return cloud;
}

}  // namespace

TEST_CASE("sight lines pass what is before a wall, end at it, and say nothing of what is behind or beside it") {
  const SightLines lines(wall(), Eigen::Vector3d::Zero());
  CHECK(lines.at({0.01, 0.4, 0.02}, 0.005) == Sight::through);
  CHECK(lines.at({0.01, 0.5, 0.02}, 0.005) == Sight::surface);
  CHECK(lines.at({0.01, 0.497, 0.02}, 0.005) == Sight::surface);
  CHECK(lines.at({0.01, 0.6, 0.02}, 0.005) == Sight::unknown);
  CHECK(lines.at({0.3, 0.4, 0.0}, 0.005) == Sight::unknown);
  CHECK(lines.at({0.0, -0.4, 0.0}, 0.005) == Sight::unknown);
}

TEST_CASE("a body before a wall was seen through on the side of the sensor, one in the wall was not") {
  const std::vector<SightLines> lines{SightLines(wall(), Eigen::Vector3d::Zero())};
  const double cap = 0.5 * (1.0 - std::cos(deg(60)));  // share of a sphere whose normals are within 60 degrees
  const Ellipsoid before(Sphere{{0.0, 0.35, 0.0}, 0.02});
  CHECK(seen_through(lines, before, deg(60), 0.005) == Approx(cap).margin(0.04));
  const Ellipsoid behind(Sphere{{0.0, 0.6, 0.0}, 0.02});
  CHECK(seen_through(lines, behind, deg(60), 0.005) == 0.0);
  const std::vector<SightLines> both{lines[0], SightLines(Cloud(), Eigen::Vector3d::Zero())};
  CHECK(seen_through(both, before, deg(60), 0.005) == Approx(cap).margin(0.04));
}
