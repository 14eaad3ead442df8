// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/split.hpp>
#include <agrisee/cloud/surface_beyond.hpp>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace {

/// A cylinder with round ends about the z axis, seen from all sides.
/// @param half_length without the ends (m)
Cloud cucumber(double radius, double half_length, double step = 0.002) {
  Cloud cloud;
  test::add_sphere(cloud, {Eigen::Vector3d::Zero(), radius}, step, test::everywhere);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.points[i].z() += static_cast<float>(cloud.normals[i].z() < 0.0f ? -half_length : half_length);
  for (double z = -half_length; z <= half_length; z += step)
    for (double a = 0.0; a < kTwoPi; a += step / radius) {
      const Eigen::Vector3f n(static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)), 0.0f);
      cloud.points.push_back(static_cast<float>(radius) * n + Eigen::Vector3f(0, 0, static_cast<float>(z)));
      cloud.normals.push_back(n);
    }
  return cloud;
}

double beyond_of(const Cloud& cloud, const Ellipsoid& body) {
  FoundBody found;
  found.fit.body = body;
  const Labels labels = assign_to_bodies(cloud, {found}, {});
  const Grid<float> grid(cloud, 0.006f);
  return surface_beyond(cloud, grid, labels, 1, body);
}

}  // namespace

TEST_CASE("the surface of a post goes on beyond a body at its end, that of a ball does not") {
  const double r = 0.02;
  Cloud ball;
  test::add_sphere(ball, {{0, 0, 0}, r}, 0.002, test::everywhere);
  CHECK(beyond_of(ball, Ellipsoid(Sphere{{0, 0, 0}, r})) == 0.0);
  const Cloud post = cucumber(r, 0.1);
  Ellipsoid end(Sphere{{0, 0, 0.1 - 0.3 * r}, r});
  end.A(2, 2) = 1.0 / (1.3 * r);
  const double beyond = beyond_of(post, end);
  CHECK(beyond > 0.05);
  CHECK(beyond < 0.2);
}

TEST_CASE("what touches a fruit does not continue its surface") {
  const double r = 0.02;
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0, 0}, r}, 0.002, [](const Eigen::Vector3d& d) { return d.x() < 0.6; });
  test::add_sphere(cloud, {{2 * r, 0, 0}, r}, 0.002, test::everywhere);  // a neighbor
  for (double y = -0.03; y < 0.03; y += 0.002)                           // a stem
    cloud.points.emplace_back(0.0f, static_cast<float>(y), static_cast<float>(1.25 * r)),
        cloud.normals.emplace_back(1, 0, 0);
  CHECK(beyond_of(cloud, Ellipsoid(Sphere{{0, 0, 0}, r})) < 0.01);
}

TEST_CASE("long fruit are found from end to end, and what is found of a post is seen to be a part of it") {
  const double r = 0.02;
  for (const double half_length : {0.0, 0.01, 0.02, 0.15}) {
    CAPTURE(half_length);
    const Cloud cloud = cucumber(r, half_length);
    const Split found = split(cloud);
    const Grid<float> grid(cloud, 0.006f);
    for (std::size_t b = 0; b < found.found.size(); ++b) {
      const double beyond = surface_beyond(cloud, grid, found.labels, static_cast<int>(b) + 1, found.found[b].fit.body);
      CHECK((half_length > 0.1 ? beyond > 0.035 : beyond < 0.01));
    }
    if (half_length > 0.1) continue;
    REQUIRE(found.found.size() == 1);
    const auto [radii, axes] = semi_axes(found.found[0].fit.body);
    CHECK(found.found[0].fit.body.center.norm() < 0.002);
    CHECK(radii[0] == Approx(r + half_length).epsilon(0.3));
    CHECK(radii[2] == Approx(r).epsilon(0.1));
    if (half_length > 0.0) CHECK(std::abs(axes(2, 0)) > 0.99);
  }
}
