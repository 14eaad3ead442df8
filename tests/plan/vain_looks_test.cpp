// SPDX-License-Identifier: BSD-3-Clause
// How often bodies that are not surely fruit were looked at.
#include <agrisee/plan/vain_looks.hpp>

#include "plan/plan_cases.hpp"

using namespace cases;

TEST_CASE("vain looks: they are counted for each body, which is known again within half its radius") {
  const auto body = [](double x, double radius = 0.04) { return Ellipsoid(Sphere{{x, 0.5, 0.2}, radius}); };
  VainLooks looks;
  CHECK(looks.count(body(0.0)) == 0);
  looks.add(body(0.0));
  looks.add(body(0.019));
  CHECK(looks.count(body(0.0)) == 2);
  CHECK(looks.count(body(0.019)) == 2);
  CHECK(looks.count(body(0.021)) == 0);
  CHECK(looks.count(body(0.021, 0.05)) == 2);
  looks.add(body(0.1));
  CHECK(looks.count(body(0.1)) == 1);
  CHECK(looks.count(body(0.0)) == 2);
  looks.clear();
  CHECK(looks.count(body(0.0)) == 0);
  CHECK(looks.count(body(0.1)) == 0);
}
