// SPDX-License-Identifier: BSD-3-Clause
// How views kept what was promised of them.
#include <agrisee/plan/promise_record.hpp>

#include "plan/plan_cases.hpp"

using namespace cases;

TEST_CASE("promise record: every view counts twice as much as the one before, by what it measured") {
  PromiseRecord record;
  CHECK(record.reliability(0.0) == 1.0);
  CHECK(record.reliability(1.0) == 1.0);
  record.weigh({0.04, 0.01}, 1.0);
  CHECK(record.reliability(0.0) == Approx(0.25));
  CHECK(record.reliability(10.0) == Approx((0.01 + 0.03) / (0.04 + 0.03)));  // as if 0.3 % of the area had been kept
  record.weigh({0.08, 0.02}, 0.5);
  CHECK(record.reliability(0.0) == Approx((0.005 + 0.02) / (0.02 + 0.04)));
  record.weigh({0.08, 0.08}, 0.25);
  CHECK(record.reliability(0.0) == 1.0);  // it kept more than what it measured promised
}

TEST_CASE("promise record: hardly any is less than a tenth") {
  CHECK(PromiseRecord::Outcome{1.0, 0.09}.blind());
  CHECK_FALSE(PromiseRecord::Outcome{1.0, 0.11}.blind());
  CHECK_FALSE(PromiseRecord::Outcome{}.blind());
}

TEST_CASE("promise record: views within 8 cm and 30 degrees of a blind one are expected to show less") {
  PromiseRecord record;
  const auto clearness = [&](double aside, double degrees) {
    return record.clearness(look_along({aside, 0.0, 0.0}, {std::sin(deg(degrees)), std::cos(deg(degrees)), 0.0}));
  };
  CHECK(clearness(0.0, 0.0) == 1.0);
  record.add_blind(look_along(Vector3d::Zero(), Vector3d::UnitY()));
  CHECK(clearness(0.0, 0.0) == Approx(0.3));
  CHECK(clearness(0.079, 29.0) == Approx(0.3));
  CHECK(clearness(0.081, 0.0) == 1.0);
  CHECK(clearness(0.0, 31.0) == 1.0);
  record.add_blind(look_along({0.1, 0.0, 0.0}, Vector3d::UnitY()));
  CHECK(clearness(0.05, 0.0) == Approx(0.09));
  CHECK(clearness(0.12, 0.0) == Approx(0.3));
}
