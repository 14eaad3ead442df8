// SPDX-License-Identifier: BSD-3-Clause
// Distances to the solids of collision checks: cases by hand, and dense sampling along segments.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/primitives.hpp>

#include <limits>

#include "catch.hpp"

using namespace agrisee;
using Eigen::Vector3d;

namespace {

/// Smallest distance at `n` points of the segment: an upper bound that is near.
template <typename Solid>
double sampled(const Solid& solid, const Vector3d& a, const Vector3d& b, int n = 4000) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= n; ++i) best = std::min(best, distance(solid, Vector3d(a + double(i) / n * (b - a))));
  return best;
}

Vector3d random_point(Rng& rng, double range) {
  return {rng.uniform(-range, range), rng.uniform(-range, range), rng.uniform(-range, range)};
}

template <typename Solid>
void check_against_sampling(const Solid& solid, std::uint64_t seed) {
  Rng rng(seed);
  int apart = 0;
  for (int i = 0; i < 1500; ++i) {
    Vector3d a = random_point(rng, 1.0), b = random_point(rng, 1.0);
    for (int axis = 0; axis < 3; ++axis)  // many segments along one or two axes
      if (i % (3 + axis) == 0) b[axis] = a[axis];
    const double exact = distance(solid, a, b), near = sampled(solid, a, b);
    REQUIRE(exact <= near + 1e-12);
    REQUIRE(near - exact < 1e-3);  // the sampling's step is 0.9 mm at most, less at the minimum
    REQUIRE(distance(solid, b, a) == Approx(exact).margin(1e-11));
    if (exact > 0.0) ++apart;
    if (exact > 0.01) REQUIRE(near - exact < 1e-5);
  }
  CHECK(apart > 500);
  CHECK(apart < 1500);
}

}  // namespace

TEST_CASE("distance from a box to a segment, by hand") {
  const Box box{{0, 0, 0}, {2, 2, 2}};
  CHECK(distance(box, {2, 0, 0}, {3, 0, 0}) == Approx(1.0));
  CHECK(distance(box, {2, -5, 0}, {2, 5, 0}) == Approx(1.0));                        // passes a face
  CHECK(distance(box, {3, -1, 0}, {-1, 3, 0}) == 0.0);                               // through an edge region, touching
  CHECK(distance(box, {4, -0.5, 0}, {-0.5, 4, 0}) == Approx(1.5 / std::sqrt(2.0)));  // passes an edge
  CHECK(distance(box, {-5, 0, 0}, {5, 0, 0}) == 0.0);                                // through it
  CHECK(distance(box, {0.1, 0, 0}, {0.2, 0, 0}) == 0.0);                             // inside
  CHECK(distance(box, {2, 2, 2}, {2, 2, 2}) == Approx(std::sqrt(3.0)));              // no length
}

TEST_CASE("distance from an upright cylinder to a segment, by hand") {
  const Cylinder c{{1, 0, 0}, 1.0, 2.0};
  CHECK(distance(c, {4, -3, 0}, {4, 3, 0}) == Approx(2.0));
  CHECK(distance(c, {1, 0, 2}, {1, 0, 5}) == Approx(1.0));             // above, on the axis
  CHECK(distance(c, {-3, 0, 3}, {5, 0, 3}) == Approx(2.0));            // above, across
  CHECK(distance(c, {3, 0, 2}, {4, 0, 3}) == Approx(std::sqrt(2.0)));  // off the rim
  CHECK(distance(c, {-9, 0, 0}, {9, 0, 0}) == 0.0);
  CHECK(distance(c, {1, 0, -9}, {1, 0, 9}) == 0.0);
  CHECK(distance(c, {4, 0, 0}, {4, 0, 0}) == Approx(2.0));
  // Past the rim on a slant: the nearest point of the segment x + z = 5 (seen from the rim's (2, 1)) is (3, 2).
  CHECK(distance(c, {5, 0, 0}, {0, 0, 5}) == Approx(std::sqrt(2.0)));
}

TEST_CASE("distance to a segment equals dense sampling") {
  check_against_sampling(Box{{0.1, -0.1, 0.2}, {0.6, 0.9, 0.3}}, 1);
  check_against_sampling(Box{{0.1, -0.1, 0.2}, {1.2, 0.01, 0.9}}, 2);
  check_against_sampling(Cylinder{{0.1, -0.1, 0.2}, 0.35, 0.9}, 3);
  check_against_sampling(Cylinder{{0.1, -0.1, 0.2}, 0.6, 0.05}, 4);
  check_against_sampling(Cylinder{{0.1, -0.1, 0.2}, 0.05, 1.2}, 5);
  check_against_sampling(KeepOut{"k", Cylinder{{0.1, -0.1, 0.2}, 0.35, 0.9}}, 6);
}

TEST_CASE("distance between segments equals dense sampling") {
  CHECK(segment_distance({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}) == Approx(1.0));       // parallel
  CHECK(segment_distance({0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {5, 0, 0}) == Approx(2.0));       // in line
  CHECK(segment_distance({0, 0, 0}, {1, 0, 0}, {0.5, -1, 1}, {0.5, 1, 1}) == Approx(1.0));  // crossing
  CHECK(segment_distance({0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {3, 4, 0}) == Approx(5.0));       // two points
  CHECK(segment_distance({0, 0, 0}, {0, 0, 0}, {-1, 2, 0}, {1, 2, 0}) == Approx(2.0));      // a point and a segment
  Rng rng(9);
  for (int i = 0; i < 200; ++i) {
    const Vector3d a = random_point(rng, 1), b = random_point(rng, 1), c = random_point(rng, 1),
                   d = random_point(rng, 1);
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= 2000; ++k) {
      const Vector3d p = a + k / 2000.0 * (b - a);
      best = std::min(best, segment_distance(p, p, c, d));
    }
    const double exact = segment_distance(a, b, c, d);
    REQUIRE(exact <= best + 1e-12);
    REQUIRE(best - exact < 1e-3);
  }
}

TEST_CASE("a space without a size is refused by name") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto fails_naming = [](const KeepOut& k) {
    try {
      k.check();
    } catch (const ParameterError& e) {
      return std::string(e.what()).find("'shelf'") != std::string::npos;
    }
    return false;
  };
  KeepOut{"shelf", Box{{0, 0, 0}, {1, 1, 1}}}.check();
  KeepOut{"shelf", Cylinder{{0, 0, 0}, 1, 1}}.check();
  CHECK(fails_naming({"shelf", Box{{0, 0, 0}, {1, 0, 1}}}));
  CHECK(fails_naming({"shelf", Box{{0, nan, 0}, {1, 1, 1}}}));
  CHECK(fails_naming({"shelf", Box{{0, 0, 0}, {1, nan, 1}}}));
  CHECK(fails_naming({"shelf", Cylinder{{0, 0, 0}, -1, 1}}));
  CHECK(fails_naming({"shelf", Cylinder{{0, 0, 0}, 1, 0}}));
  CHECK(fails_naming({"shelf", Cylinder{{0, 0, nan}, 1, 1}}));
}
