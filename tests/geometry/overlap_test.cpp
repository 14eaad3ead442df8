// SPDX-License-Identifier: BSD-3-Clause
// Overlaps of capsules and cylinders with solids: cases by hand, touching, and points sampled inside.
#include <agrisee/core/pose.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/overlap.hpp>

#include <limits>

#include "catch.hpp"

using namespace agrisee;
using Eigen::Vector3d;

namespace {

OrientedCylinder random_cylinder(Rng& rng) {
  return {{rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15), rng.uniform(-0.15, 0.15)},
          rng.direction(),
          rng.uniform(0.02, 0.06),
          rng.uniform(0.02, 0.2)};
}

Vector3d point_inside(const OrientedCylinder& c, Rng& rng) {
  const Vector3d x = any_orthogonal(c.axis), y = c.axis.cross(x);
  const double r = c.radius * std::sqrt(rng.uniform()), a = rng.uniform(0.0, kTwoPi);
  return c.center + rng.uniform(-0.5, 0.5) * c.height * c.axis + r * (std::cos(a) * x + std::sin(a) * y);
}

double outside(const OrientedCylinder& c, const Vector3d& p) { return (nearest_point(c, p) - p).norm(); }
double outside(const Box& b, const Vector3d& p) { return distance(b, p); }
double outside(const Cylinder& c, const Vector3d& p) { return distance(c, p); }

/// Grown by `by` on every side.
OrientedCylinder grown(OrientedCylinder c, double by) {
  c.radius += by;
  c.height += 2.0 * by;
  return c;
}

template <typename Solid>
void check_against_points(const Solid& solid, std::uint64_t seed) {
  Rng rng(seed);
  int overlaps = 0, proved = 0;
  for (int i = 0; i < 800; ++i) {
    const OrientedCylinder body = random_cylinder(rng);
    const bool answer = overlap(body, solid);
    overlaps += answer;
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 300 && nearest > 0.0; ++k) nearest = std::min(nearest, outside(solid, point_inside(body, rng)));
    if (nearest == 0.0) {
      REQUIRE(overlap(grown(body, 1e-5), solid));  // a common point: no doubt but at the very border
      ++proved;
    }
    if (!answer) REQUIRE(nearest > 0.0);
    // A capsule about it overlaps whenever it does.
    if constexpr (!std::is_same_v<Solid, OrientedCylinder>)
      if (answer) REQUIRE(overlap(enclosing_capsule(grown(body, 1e-5)), solid));
  }
  CHECK(proved > 100);
  CHECK(overlaps >= proved);
  CHECK(overlaps - proved < 80);  // little more than the sampling found
}

}  // namespace

TEST_CASE("capsules overlap solids, by hand") {
  const Box box{{0, 0, 0}, {2, 2, 2}};
  CHECK(overlap(Capsule{{1.4, -5, 0}, {1.4, 5, 0}, 0.5}, box));
  CHECK_FALSE(overlap(Capsule{{1.6, -5, 0}, {1.6, 5, 0}, 0.5}, box));
  CHECK_FALSE(overlap(Capsule{{1.5, -5, 0}, {1.5, 5, 0}, 0.5}, box));     // touches
  CHECK(overlap(Capsule{{0, 0, 0}, {0, 0, 0}, 0.1}, box));                // inside
  CHECK_FALSE(overlap(Capsule{{1.4, 1.4, 0}, {1.4, 1.4, 0}, 0.5}, box));  // off the edge: 0.566 away
  CHECK(overlap(Capsule{{1.3, 1.3, 0}, {1.3, 1.3, 0}, 0.5}, box));
  const KeepOut tree{"tree", Cylinder{{0, 0, 0}, 1.0, 2.0}};
  CHECK(overlap(Capsule{{-3, 0, 1.4}, {3, 0, 1.4}, 0.5}, tree));
  CHECK_FALSE(overlap(Capsule{{-3, 0, 1.5}, {3, 0, 1.5}, 0.5}, tree));
  const Capsule a{{0, 0, 0}, {1, 0, 0}, 0.5};
  CHECK(overlap(a, Capsule{{0.5, 0.9, -2}, {0.5, 0.9, 2}, 0.5}));
  CHECK_FALSE(overlap(a, Capsule{{0.5, 1.0, -2}, {0.5, 1.0, 2}, 0.5}));
  CHECK_FALSE(overlap(a, Capsule{{2.1, 0, 0}, {3, 0, 0}, 0.5}));
}

TEST_CASE("cylinders of any direction overlap solids, by hand") {
  const Box box{{0, 0, 0}, {2, 2, 2}};
  const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ(), slant = Vector3d(1, 0, 1).normalized();
  CHECK(overlap(OrientedCylinder{{1.4, 0, 0}, x, 0.3, 1.0}, box));
  CHECK_FALSE(overlap(OrientedCylinder{{1.5, 0, 0}, x, 0.3, 1.0}, box));  // its flat end touches
  CHECK_FALSE(overlap(OrientedCylinder{{1.3, 0, 0}, z, 0.3, 1.0}, box));  // its side touches
  CHECK(overlap(OrientedCylinder{{1.29, 0, 0}, z, 0.3, 1.0}, box));
  // Tilted by 45 degrees its rim is 0.5 h cos + r sin ahead of its center.
  const double ahead = (0.5 + 0.3) * std::sqrt(0.5);
  CHECK(overlap(OrientedCylinder{{1.0 + ahead - 0.01, 0, 0}, slant, 0.3, 1.0}, box));
  CHECK_FALSE(overlap(OrientedCylinder{{1.0 + ahead + 0.01, 0, 0}, slant, 0.3, 1.0}, box));
  const Cylinder tree{{0, 0, 0}, 1.0, 2.0};
  CHECK_FALSE(overlap(OrientedCylinder{{1.5, 0, 0}, x, 0.3, 1.0}, tree));  // flat against round
  CHECK(overlap(OrientedCylinder{{1.49, 0, 0}, x, 0.3, 1.0}, tree));
  CHECK_FALSE(overlap(OrientedCylinder{{0, 0, 1.3}, x, 0.3, 9.0}, tree));  // lies on it
  CHECK(overlap(OrientedCylinder{{0, 0, 1.29}, x, 0.3, 9.0}, tree));
  const OrientedCylinder rod{{0, 0, 0}, x, 0.1, 4.0};
  CHECK(overlap(OrientedCylinder{{0, 0, 0.19}, Vector3d::UnitY(), 0.1, 4.0}, rod));
  CHECK_FALSE(overlap(OrientedCylinder{{0, 0, 0.21}, Vector3d::UnitY(), 0.1, 4.0}, rod));
}

TEST_CASE("cylinders of any direction overlap where points lie in both") {
  check_against_points(Box{{0, 0, 0}, {0.1, 0.16, 0.06}}, 1);
  check_against_points(Cylinder{{0, 0, 0}, 0.06, 0.1}, 2);
  check_against_points(OrientedCylinder{{0, 0, 0}, Vector3d(1, 2, 3).normalized(), 0.05, 0.15}, 3);
}

TEST_CASE("support and nearest point belong together") {
  Rng rng(4);
  const Box box{{0.1, 0.2, 0.3}, {0.5, 0.2, 0.4}};
  const Cylinder upright{{0.1, 0.2, 0.3}, 0.2, 0.5};
  for (int i = 0; i < 2000; ++i) {
    const OrientedCylinder c = random_cylinder(rng);
    const Vector3d far = 5.0 * rng.direction();
    // The plane through the point nearest to one outside, across the line between, supports the solid.
    const auto check = [&](const auto& solid) {
      const Vector3d q = nearest_point(solid, far), v = far - q;
      REQUIRE(support(solid, v) == Approx(v.dot(q)).margin(1e-12));
      REQUIRE((nearest_point(solid, q) - q).norm() < 1e-12);
    };
    check(c);
    check(box);
    check(upright);
    REQUIRE((far - nearest_point(box, far)).norm() == Approx(distance(box, far)));
    REQUIRE((far - nearest_point(upright, far)).norm() == Approx(distance(upright, far)));
  }
}

TEST_CASE("what is thinner than a touch overlaps what it passes through") {
  const Box box{{0, 0, 0}, {2, 2, 2}};
  const Cylinder tree{{0, 0, 0}, 1.0, 2.0};
  const KeepOut space{"box", box};
  const Vector3d x = Vector3d::UnitX(), slant = Vector3d(1, 2, 2).normalized();
  for (const double thin : {0.0, 1e-9, 0.5 * kTouch, kTouch, 1.5 * kTouch, 2.0 * kTouch}) {
    CAPTURE(thin);
    const auto hits = [&](const Vector3d& a, const Vector3d& b, const auto& solid) {
      return overlap(Capsule{a, b, thin}, solid);
    };
    CHECK(hits({-5, 0.5, 0.3}, {5, 0.5, 0.4}, box));
    CHECK(hits({-5, 0.5, 0.3}, {5, 0.5, 0.4}, space));
    CHECK(hits({-5, 0.5, 0.3}, {5, 0.5, 0.4}, tree));
    CHECK(hits({0.2, 0.1, 0.3}, {0.2, 0.1, 0.3}, box));  // a point inside
    CHECK_FALSE(hits({-5, 1.00001, 0.3}, {5, 1.00001, 0.4}, box));
    CHECK_FALSE(hits({-5, 1.00001, 0.3}, {5, 1.00001, 0.4}, tree));
    CHECK_FALSE(hits({1.00001, 0, 0}, {1.00001, 0, 0}, box));
    CHECK(overlap(Capsule{{-1, 0, 0}, {1, 0, 0}, thin}, Capsule{{0, -1, 0}, {0, 1, 0}, thin}));
    CHECK_FALSE(overlap(Capsule{{-1, 0, 0}, {1, 0, 0}, thin}, Capsule{{0, -1, 1e-5}, {0, 1, 1e-5}, thin}));
    for (const double height : {thin, 4.0}) {  // a grain, and a wire
      CHECK(overlap(OrientedCylinder{{0.5, 0.5, 0.3}, slant, thin, height}, box));
      CHECK(overlap(OrientedCylinder{{0.5, 0.5, 0.3}, slant, thin, height}, tree));
      CHECK_FALSE(overlap(OrientedCylinder{{0, 1.00001, 0}, x, thin, height}, box));
      CHECK_FALSE(overlap(OrientedCylinder{{0, 1.00001, 0}, x, thin, height}, tree));
    }
    CHECK(overlap(OrientedCylinder{{0, 0, 1}, Vector3d::UnitZ(), 0.5, 4.0}, OrientedCylinder{{0, 0, 2}, x, 4.0, thin}));
  }
}

TEST_CASE("what is not finite overlaps") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Cylinder tree{{0, 0, 0}, 1.0, 2.0};
  CHECK(overlap(Capsule{{nan, 9, 9}, {9, 9, 9}, 0.1}, tree));
  CHECK(overlap(Capsule{{9, 9, 9}, {9, 9, 8}, nan}, tree));
  CHECK(overlap(OrientedCylinder{{nan, 9, 9}, Vector3d::UnitX(), 0.1, 0.1}, tree));
  CHECK(overlap(OrientedCylinder{{9, 9, 9}, Vector3d::UnitX(), 0.1, 0.1}, Cylinder{{nan, 0, 0}, 1.0, 2.0}));
}
