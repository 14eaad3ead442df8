// SPDX-License-Identifier: BSD-3-Clause
// Joint limits, turns, distances and times of moves.
#include <agrisee/arm/limits.hpp>
#include <agrisee/core/random.hpp>

#include <limits>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::arm;

TEST_CASE("angles wrap into the range above -pi and up to pi") {
  CHECK(wrap(0.0) == 0.0);
  CHECK(wrap(kPi) == kPi);
  CHECK(wrap(-kPi) == kPi);
  CHECK(wrap(3.0 * kPi) == Approx(kPi));
  CHECK(wrap(kTwoPi + 0.5) == Approx(0.5));
  CHECK(wrap(-kTwoPi - 0.5) == Approx(-0.5));
  Rng rng(1);
  for (int i = 0; i < 10000; ++i) {
    const double a = rng.uniform(-50.0, 50.0), w = wrap(a);
    REQUIRE(w > -kPi);
    REQUIRE(w <= kPi);
    REQUIRE(w == std::remainder(a, kTwoPi));  // which is exact
  }
}

TEST_CASE("the nearest turn equals the best of all turns within the limits") {
  Rng rng(2);
  JointLimits limits;
  for (int i = 0; i < 5000; ++i) {
    Joints q, reference;
    for (int j = 0; j < 6; ++j) {
      q[j] = rng.uniform(-kPi, kPi);
      reference[j] = rng.uniform(-8.0, 8.0);
      limits.max[j] = rng.uniform(0.0, 8.0);
      limits.min[j] = rng.uniform(-8.0, 0.0);
    }
    const auto found = nearest(q, reference, limits);
    Joints best;
    bool all = true;
    for (int j = 0; j < 6; ++j) {
      double d = std::numeric_limits<double>::infinity();
      for (int k = -4; k <= 4; ++k) {
        const double a = q[j] + kTwoPi * k;
        if (a < limits.min[j] || a > limits.max[j] || std::abs(a - reference[j]) >= d) continue;
        d = std::abs(a - reference[j]);
        best[j] = a;
      }
      all = all && std::isfinite(d);
    }
    REQUIRE(found.has_value() == all);
    if (all) REQUIRE((*found - best).cwiseAbs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("a joint keeps its turn where it can") {
  const JointLimits limits = JointLimits::ur3();
  const Joints present = Joints::Constant(3.0);
  const Joints q = Joints::Constant(-3.0);  // 0.28 rad away across pi, but for the elbow, which must go back
  const Joints near = nearest(q, present, limits).value();
  CHECK(near[0] == Approx(kTwoPi - 3.0));
  CHECK(near[5] == Approx(kTwoPi - 3.0));
  CHECK(near[2] == Approx(-3.0));
}

TEST_CASE("a move takes as long as its slowest joint") {
  const Joints from = Joints::Zero();
  Joints to = Joints::Zero();
  CHECK(move_time(from, to) == 0.0);
  to[0] = kPi / 2;
  CHECK(move_time(from, to) == Approx(0.5));  // 90 degrees at 180 degrees a second
  to[5] = -kPi;
  CHECK(move_time(from, to) == Approx(0.5));  // the wrist turns twice as fast
  to[4] = 1.5 * kPi;
  CHECK(move_time(from, to) == Approx(0.75));
  CHECK(joint_distance(from, to) == Approx(kPi * std::sqrt(0.25 + 1.0 + 2.25)));
}

TEST_CASE("limits that are none are refused by name") {
  JointLimits limits;
  limits.check();
  limits.min[3] = 7.0;
  CHECK_THROWS_AS(limits.check(), ParameterError);
  limits = {};
  limits.max[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(limits.check(), ParameterError);
  limits = {};
  limits.velocity[5] = 0.0;
  CHECK_THROWS_AS(limits.check(), ParameterError);
}
