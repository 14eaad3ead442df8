// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/hidden_points.hpp>
#include <agrisee/core/random.hpp>

#include <limits>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// A square of `size` (m) at the distance y, `spacing` apart, about the y axis; noise along y.
void add_wall(Cloud& cloud, double y, double size, double spacing, double noise = 0.0) {
  Rng rng(1);
  for (double x = -0.5 * size; x <= 0.5 * size; x += spacing)
    for (double z = -0.5 * size; z <= 0.5 * size; z += spacing)
      cloud.points.push_back(Eigen::Vector3d(x, y + noise * rng.normal(), z).cast<float>());
}

const Eigen::Vector3d kEye = Eigen::Vector3d::Zero();

}  // namespace

TEST_CASE("a wall hides what is behind it, and nothing else") {
  Cloud cloud;
  add_wall(cloud, 0.5, 0.2, 0.004);
  CHECK(hidden_share(cloud, kEye, 0.02) == 0.0);
  const auto front = static_cast<double>(cloud.size());
  add_wall(cloud, 1.0, 0.8, 0.008);
  const auto back = static_cast<double>(cloud.size()) - front;
  const double share = hidden_share(cloud, kEye, 0.02, 100000);
  CHECK(share == Approx(back / 4.0 / (front + back)).epsilon(0.2));  // as wide as the shadow of the wall, 0.4 m
  CHECK(hidden_share(cloud, kEye, 0.6) == 0.0);
  CHECK(hidden_share(cloud, {0.0, 1.5, 0.0}, 0.02, 100000) == Approx(front / (front + back)).epsilon(0.1));
  CHECK(hidden_share(cloud, {0.0, 0.75, 0.0}, 0.02) == 0.0);  // from between them
}

TEST_CASE("what is seen beside a border is not hidden, nor are noisy points") {
  Cloud cloud;
  for (double x = -0.2; x <= 0.2; x += 0.004)  // two leaves with a gap, and a wall in the gap
    for (double z = -0.2; z <= 0.2; z += 0.004)
      cloud.points.push_back(
          (std::abs(x) > 0.02 ? Eigen::Vector3d(x, 0.5, z) : Eigen::Vector3d(2.0 * x, 1.0, 2.0 * z)).cast<float>());
  CHECK(hidden_share(cloud, kEye, 0.02) == 0.0);
  Cloud noisy;
  add_wall(noisy, 0.5, 0.4, 0.004, 0.006);
  CHECK(hidden_share(noisy, kEye, 0.02) < 0.01);
}

TEST_CASE("few points, equal ones and such that are not finite hide nothing") {
  Cloud cloud;
  CHECK(hidden_share(cloud, kEye, 0.02) == 0.0);
  cloud.points.assign(50, Eigen::Vector3f(0.0f, 0.5f, 0.0f));
  CHECK(hidden_share(cloud, kEye, 0.02) == 0.0);
  cloud.points.emplace_back(0.0f, 0.0f, 0.0f);  // where the sensor is
  cloud.points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
  cloud.points.emplace_back(0.0f, std::numeric_limits<float>::infinity(), 0.0f);
  CHECK(hidden_share(cloud, kEye, 0.02) == 0.0);
}
