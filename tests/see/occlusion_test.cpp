// SPDX-License-Identifier: BSD-3-Clause
// Sight lines by hand, and the freest direction against dense sampling.
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/see/occlusion.hpp>

#include "catch.hpp"
#include "see/shapes.hpp"

using namespace agrisee;
using namespace agrisee::see;
using test::Points;

namespace {

Aabb box_of(const Points& cloud) {
  Aabb box;
  for (const auto& p : cloud) box.extend(p.cast<double>());
  return box;
}

/// A frontier whose normal is z.
Frontier frontier_at(const Eigen::Vector3d& p) {
  Frontier f;
  f.index = 7;
  f.point = p;
  return f;
}

bool visible(const Points& cloud, const Eigen::Vector3d& p, const Eigen::Vector3d& sensor,
             const Parameters& parameters = {}) {
  const KdTree<float> tree(cloud);
  const double start = surface_depth<float>(tree, frontier_at(p), parameters.upsilon);
  const bool a = is_visible<float>(tree, p, start, sensor, parameters, box_of(cloud));
  const bool b = is_visible<float>(Grid<float>(cloud, 0.01f), p, start, sensor, parameters, box_of(cloud));
  Aabb all;
  all.extend(Eigen::Vector3d::Constant(-10.0));
  all.extend(Eigen::Vector3d::Constant(10.0));
  REQUIRE(a == b);
  REQUIRE(a == is_visible<float>(tree, p, start, sensor, parameters, all));  // bounds only save time
  return a;
}

/// Largest of the smallest angles to the occluders over a dense set of directions in the cone.
double sampled_clearance(const std::vector<Eigen::Vector3f>& occluders, const Eigen::Vector3d& axis, double max_angle) {
  double best = 0.0;
  const int n = 40000;
  for (int i = 0; i < n; ++i) {  // Fibonacci lattice: no direction is farther than about 0.7 degrees from one of it
    const double z = 1.0 - (2.0 * i + 1.0) / n, a = i * kPi * (3.0 - std::sqrt(5.0)), s = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d u(s * std::cos(a), s * std::sin(a), z);
    if (u.dot(axis) < std::cos(max_angle)) continue;
    double nearest = -1.0;
    for (const auto& o : occluders) nearest = std::max(nearest, o.cast<double>().dot(u));
    best = std::max(best, std::acos(std::min(1.0, nearest)));
  }
  return best;
}

}  // namespace

TEST_CASE("the surface's own points end where a ball along the normal is empty", "[see]") {
  const Eigen::Vector3d p = Eigen::Vector3d::Zero();
  const auto depth = [&](const Points& cloud) {
    return surface_depth<float>(KdTree<float>(cloud), frontier_at(p), 0.005);
  };
  REQUIRE(depth({}) == Approx(0.010));  // the first two balls hold the frontier, which lies on the edge of the second
  Points points{{0, 0, 0}};
  REQUIRE(depth(points) == Approx(0.010));
  points.push_back({0, 0, 0.012f});
  REQUIRE(depth(points) == Approx(0.020));
  points.push_back({0, 0, 0.03f});
  REQUIRE(depth(points) == Approx(0.020));
}

TEST_CASE("sight lines by hand", "[see]") {
  const Points plane = test::rectangle(-0.1, 0.1, -0.1, 0.1, 20000);
  const Eigen::Vector3d p = Eigen::Vector3d::Zero();
  REQUIRE(visible(plane, p, {0, 0, 0.4}));
  REQUIRE(visible(plane, p, {0.1, 0, 0.2}));
  REQUIRE_FALSE(visible(plane, p, {0.4, 0, 0.04}));  // grazing: 1 cm along the line is still 1 mm above the plane
  REQUIRE_FALSE(visible(plane, p, p));
  REQUIRE_FALSE(visible(plane, p, {0.08, 0, 0}));
  REQUIRE(visible(Points(), p, {0, 0, 1}));

  Points screened = plane;
  for (const auto& q : test::rectangle(-0.03, 0.03, -0.03, 0.03, 4000))
    screened.push_back(q + Eigen::Vector3f(0, 0, 0.1f));
  REQUIRE_FALSE(visible(screened, p, {0, 0, 0.4}));
  REQUIRE_FALSE(visible(screened, p, {0, 0, 0.08}));   // psi counts, not the sensor's distance
  REQUIRE(visible(screened, p, {0.2, 0, 0.3}));        // past its edge by 3.7 cm
  REQUIRE_FALSE(visible(screened, p, {0.1, 0, 0.3}));  // its edge is within upsilon of the line
  Parameters near;
  near.psi = 0.08;  // farther occluders do not count: the last ball is 8.5 cm away
  REQUIRE(visible(screened, p, {0, 0, 0.4}, near));
  near.psi = 0.095;  // now 10 cm
  REQUIRE_FALSE(visible(screened, p, {0, 0, 0.4}, near));

  Points wall = plane;  // beside the line, at upsilon and a hair more or less
  wall.push_back({0.0051f, 0.0f, 0.05f});
  REQUIRE(visible(wall, p, {0, 0, 0.4}));
  wall.push_back({0.0049f, 0.0f, 0.05f});
  REQUIRE_FALSE(visible(wall, p, {0, 0, 0.4}));
}

TEST_CASE("the freest direction by hand", "[see]") {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  REQUIRE(freest_direction({}, z, 1.0).direction == z);
  REQUIRE(freest_direction({}, z, 1.0).clearance == Approx(kPi));
  const double tolerance = deg(0.2);
  // One occluder: opposite to it, or as far as the cone allows.
  auto free = freest_direction({-Eigen::Vector3f::UnitZ()}, z, kPi, tolerance);
  REQUIRE(free.clearance > kPi - 2.0 * tolerance);
  free = freest_direction({Eigen::Vector3f::UnitZ()}, z, deg(60), tolerance);
  REQUIRE(free.clearance == Approx(deg(60)).margin(2.0 * tolerance));
  // Six along the axes: the corners between three.
  std::vector<Eigen::Vector3f> six;
  for (int a = 0; a < 3; ++a)
    for (float s : {1.0f, -1.0f}) six.push_back(s * Eigen::Vector3f::Unit(a));
  free = freest_direction(six, z, kPi, tolerance);
  REQUIRE(free.clearance == Approx(std::acos(1.0 / std::sqrt(3.0))).margin(tolerance));
  REQUIRE(free.direction.cwiseAbs().minCoeff() > 0.56);
}

TEST_CASE("the freest direction equals dense sampling", "[see]") {
  const double tolerance = deg(0.5);
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const Eigen::Vector3d axis = rng.direction();
    std::vector<Eigen::Vector3f> occluders;
    const std::size_t n = std::vector<std::size_t>{1, 2, 3, 10, 100, 800}[seed % 6];
    while (occluders.size() < n) {
      const Eigen::Vector3d o = rng.direction();
      if (seed > 6 && o.dot(axis) > 0.4) continue;  // half of the sphere or so is free
      occluders.push_back(o.cast<float>());
    }
    const double cone = seed % 2 ? deg(80) : kPi;
    const FreeDirection free = freest_direction(occluders, axis, cone, tolerance);
    REQUIRE(free.direction.norm() == Approx(1.0).margin(1e-6));
    REQUIRE(free.direction.dot(axis) >= std::cos(std::min(kPi, cone + 1.1 * tolerance)) - 1e-6);
    float nearest = -1.0f;
    for (const auto& o : occluders) nearest = std::max(nearest, o.dot(free.direction.cast<float>()));
    REQUIRE(free.clearance == Approx(std::acos(std::min(1.0f, nearest))).margin(1e-3));  // it is what it says
    const double sampled = sampled_clearance(occluders, axis, cone);
    REQUIRE(free.clearance >= sampled - tolerance - 1e-3);
    REQUIRE(free.clearance <= sampled + deg(1.0) + tolerance);
  }
}

TEST_CASE("the freest direction, bad input", "[see]") {
  const std::vector<Eigen::Vector3f> one{Eigen::Vector3f::UnitX()};
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  REQUIRE_THROWS_AS(freest_direction(one, Eigen::Vector3d::Zero(), 1.0), InputError);
  REQUIRE_THROWS_AS(freest_direction(one, Eigen::Vector3d::Constant(std::nan("")), 1.0), InputError);
  REQUIRE_THROWS_AS(freest_direction(one, z, 0.0), InputError);
  REQUIRE_THROWS_AS(freest_direction(one, z, 1.0, 0.0), InputError);
  REQUIRE(freest_direction(one, z, 1e-3).direction.dot(z) > std::cos(deg(0.6)));
}

TEST_CASE("an occluded proposal moves to where its frontier can be seen", "[see]") {
  Points cloud = test::rectangle(-0.1, 0.1, -0.1, 0.1, 5000);
  for (const auto& q : test::rectangle(-0.05, 0.05, -0.2, 0.2, 8000)) cloud.push_back(q + Eigen::Vector3f(0, 0, 0.16f));
  HashGrid<float> points(0.01f);
  for (const auto& q : cloud) points.insert(q);
  const Frontier f = frontier_at(Eigen::Vector3d::Zero());
  const Parameters p;
  const Eigen::Vector3d first(0.05, 0.0, 0.37);
  REQUIRE_FALSE(visible(cloud, f.point, propose(f, p.view_distance).position));
  const double start = surface_depth<float>(points, f, p.upsilon);
  const ViewProposal moved = propose_around(points, f, start, first, p);
  REQUIRE(moved.frontier == 7);
  REQUIRE((moved.position - f.point).norm() == Approx(p.view_distance));
  REQUIRE(std::abs(moved.position.x()) > std::abs(moved.position.y()));  // past the long edges of the screen
  // Seen from 1 cm above the plane, all below is full: between the plane (84 degrees) and the screen's edge (18) the
  // middle is freest.
  REQUIRE(std::acos(moved.position.normalized().z()) == Approx(deg(53)).margin(deg(4)));
  REQUIRE(visible(cloud, f.point, moved.position));

  // Occluders are those within psi of the frontier.
  Parameters near = p;
  near.psi = 0.05;
  REQUIRE(occluder_directions(points, f.point, f.point, near.psi).size() < cloud.size() / 2);
  REQUIRE(occluder_directions(points, f.point, f.point, 1.0).size() == cloud.size());
  REQUIRE(occluder_directions(points, f.point, cloud[0].cast<double>(), 1.0).size() == cloud.size() - 1);
  // Without any, the view is along the normal.
  REQUIRE((propose_around(HashGrid<float>(0.01f), f, 0.0, first, p).position - propose(f, 0.38).position).norm() <
          1e-9);
}
