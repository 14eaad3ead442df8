// SPDX-License-Identifier: BSD-3-Clause
// By what bodies compete, and who gets a point.
#include <agrisee/cloud/split.hpp>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

TEST_CASE("of equally near bodies a point gets the first") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0.5, 0.2}, 0.035}, 0.01, test::everywhere);
  FoundBody body;
  body.fit.body = Ellipsoid(Sphere{{0, 0.5, 0.2}, 0.035});
  CHECK(assign_to_bodies(cloud, {body, body}) == Labels(cloud.size(), 1));
}
