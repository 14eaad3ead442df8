// SPDX-License-Identifier: BSD-3-Clause
// Angles between directions of any length, and between orientations.
#include <agrisee/geometry/angle.hpp>

#include <limits>

#include "catch.hpp"

using namespace agrisee;
using Eigen::Vector3d;

TEST_CASE("the angle between directions does not depend on their lengths, and is exact when small") {
  CHECK(angle_between({2, 0, 0}, {0, 0.1, 0}) == Approx(kPi / 2));
  CHECK(angle_between({1, 1, 0}, {5, 0, 0}) == Approx(kPi / 4));
  CHECK(angle_between({1, 2, 3}, {-2, -4, -6}) == Approx(kPi));
  CHECK(angle_between({1, 0, 0}, {1, 1e-9, 0}) == Approx(1e-9));
  CHECK(std::isnan(angle_between({1, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0})));
}

TEST_CASE("the turn between poses is that of their orientations, wherever they are") {
  const Pose a = pose_from_xyz_rpy({1, 2, 3}, {0.3, -0.2, 1.0});
  CHECK(turn_between(a, a) == Approx(0.0).margin(1e-7));
  for (const double turn : {1e-3, 0.5, 3.0, -0.5}) {
    Pose b = a;
    b.rotate(Eigen::AngleAxisd(turn, Vector3d(1, -2, 2).normalized()));
    b.translation() = Vector3d(-4, 0, 9);
    CHECK(turn_between(a, b) == Approx(std::abs(turn)));
    CHECK(turn_between(b, a) == Approx(std::abs(turn)));
  }
  CHECK(turn_between(a, a * pose_from_xyz_rpy({0, 0, 0}, {0, 0, kPi})) == Approx(kPi));
}
