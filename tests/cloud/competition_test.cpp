// SPDX-License-Identifier: BSD-3-Clause
// By what bodies compete, and who gets a point.
#include <agrisee/cloud/split.hpp>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

TEST_CASE("regions that are too small, or hollow, propose nothing and are counted") {
  const auto counts = [](double radius, float outward) {  // of a ball, where fruit of 30 to 40 mm are expected
    Cloud cloud;
    test::add_sphere(cloud, {{0, 0.5, 0.2}, radius}, radius / 14.0, test::everywhere);
    for (auto& n : cloud.normals) n *= outward;
    SplitParameters p;
    p.bodies.radius_min = 0.030, p.bodies.radius_max = 0.040;
    const Split found = split(cloud, p);
    CHECK(found.regions_found == 1);
    CHECK(found.found.empty());
    return found.bodies;
  };
  CHECK(counts(0.014, 1.0f).too_small == 1);
  CHECK(counts(0.014, 1.0f).inside_out == 0);
  CHECK(counts(0.035, -1.0f).inside_out == 1);
}

TEST_CASE("balls overlap by their radii less their distance") {
  const Ellipsoid a(Sphere{{0, 0, 0}, 0.03});
  CHECK(detail::overlap(a, Ellipsoid(Sphere{{0.04, 0, 0}, 0.02})) == Approx(0.01));
  CHECK(detail::overlap(a, Ellipsoid(Sphere{{0, 0, -0.06}, 0.02})) == Approx(-0.01));
  CHECK(detail::overlap(a, a) == Approx(0.06));
}

TEST_CASE("of equally near bodies a point gets the first") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0.5, 0.2}, 0.035}, 0.01, test::everywhere);
  FoundBody body;
  body.fit.body = Ellipsoid(Sphere{{0, 0.5, 0.2}, 0.035});
  CHECK(assign_to_bodies(cloud, {body, body}) == Labels(cloud.size(), 1));
}
