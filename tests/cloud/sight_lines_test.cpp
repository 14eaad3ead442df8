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

const Ellipsoid kFruit(Sphere{{0.0, 0.4, 0.0}, 0.03});

/// What the origin sees of kFruit where `shows` admits its points, before a wall if there is one.
template <typename Shows>
Cloud front_of_fruit(Shows&& shows, bool before_wall) {
  Cloud cloud = before_wall ? wall() : Cloud();
  for (double x = -0.03; x <= 0.03; x += 0.0015)
    for (double z = -0.03; z <= 0.03; z += 0.0015) {
      const double rest = 0.03 * 0.03 - x * x - z * z;
      if (rest > 0.0 && shows(x, z)) cloud.points.push_back(Eigen::Vector3d(x, 0.4 - std::sqrt(rest), z).cast<float>());
    }
  return cloud;
}

/// What the origin sees on kFruit in these points.
double seen_on_fruit(const Cloud& cloud) { return seen_on(SightLines(cloud, Eigen::Vector3d::Zero()), kFruit, 0.004); }

}  // namespace

TEST_CASE("a fruit fills its disc, a strip of it does not, whatever is beside it") {
  const auto all = [](double, double) { return true; };
  const auto strip = [](double x, double) { return std::abs(x) < 0.009; };
  CHECK(seen_on_fruit(front_of_fruit(all, true)) > 0.95);
  CHECK(seen_on_fruit(front_of_fruit(all, false)) > 0.95);
  CHECK(seen_on_fruit(front_of_fruit(strip, true)) == Approx(0.45).margin(0.12));
  CHECK(seen_on_fruit(front_of_fruit(strip, false)) == Approx(0.45).margin(0.12));
}

TEST_CASE("what occludes a fruit does not speak against it") {
  Cloud half = front_of_fruit([](double x, double) { return x < 0.0; }, true);
  CHECK(seen_on_fruit(half) == Approx(0.5).margin(0.12));
  for (int i = 0; i <= 26; ++i)  // a leaf before the other half
    for (int j = -26; j <= 26; ++j) half.points.emplace_back(0.0011f * float(i), 0.3f, 0.0011f * float(j));
  CHECK(seen_on_fruit(half) > 0.85);
}

TEST_CASE("sight lines pass what is before a wall, end at it, and say nothing of what is behind or beside it") {
  const SightLines lines(wall(), Eigen::Vector3d::Zero());
  CHECK(lines.at({0.01, 0.4, 0.02}, 0.005) == Sight::through);
  CHECK(lines.at({0.01, 0.5, 0.02}, 0.005) == Sight::surface);
  CHECK(lines.at({0.01, 0.497, 0.02}, 0.005) == Sight::surface);
  CHECK(lines.at({0.01, 0.6, 0.02}, 0.005) == Sight::unknown);
  CHECK(lines.at({0.3, 0.4, 0.0}, 0.005) == Sight::unknown);
  CHECK(lines.at({0.0, -0.4, 0.0}, 0.005) == Sight::unknown);
}

TEST_CASE("what is nearer in the next direction hides a place, on all sides alike") {
  Cloud cloud = wall();
  cloud.points.push_back(Eigen::Vector3f(0.0f, 0.3f, 0.0f));
  const SightLines lines(cloud, Eigen::Vector3d::Zero());
  const auto hidden = [&](const Eigen::Vector3d& step) {  // how far from the middle, in steps of 0.1 mm
    int steps = 0;
    while (lines.at(Eigen::Vector3d(0.0, 0.45, 0.0) + 1e-4 * steps * step, 0.005) == Sight::unknown) ++steps;
    REQUIRE(lines.at(Eigen::Vector3d(0.0, 0.45, 0.0) + 1e-4 * steps * step, 0.005) == Sight::through);
    return steps;
  };
  // Three cells in each direction are hidden: that of the point and those beside it.
  const int across = hidden(Eigen::Vector3d::UnitX()) + hidden(-Eigen::Vector3d::UnitX());
  const int up = hidden(Eigen::Vector3d::UnitZ()) + hidden(-Eigen::Vector3d::UnitZ());
  CHECK(across == Approx(up).margin(2));
  CHECK(across > 30);
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
