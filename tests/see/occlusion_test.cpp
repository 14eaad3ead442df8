// SPDX-License-Identifier: BSD-3-Clause
// Sight lines by hand, the freest direction against dense sampling, the graph against every pair, and the order of
// views.
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/see/selector.hpp>

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

bool visible(const Points& cloud, const Eigen::Vector3d& p, const Eigen::Vector3d& sensor,
             const Parameters& params = {}) {
  const bool a = is_visible<float>(KdTree<float>(cloud), p, sensor, params, box_of(cloud));
  const bool b = is_visible<float>(Grid<float>(cloud, 0.01f), p, sensor, params, box_of(cloud));
  Aabb all;
  all.extend(Eigen::Vector3d::Constant(-10.0));
  all.extend(Eigen::Vector3d::Constant(10.0));
  REQUIRE(a == b);
  REQUIRE(a == is_visible<float>(KdTree<float>(cloud), p, sensor, params, all));  // bounds only save time
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

TEST_CASE("sight lines by hand", "[see]") {
  const Points plane = test::rectangle(-0.1, 0.1, -0.1, 0.1, 20000);
  const Eigen::Vector3d p = Eigen::Vector3d::Zero();
  REQUIRE(visible(plane, p, {0, 0, 0.4}));
  REQUIRE(visible(plane, p, {0.2, 0, 0.2}));  // the surface's own points end
  REQUIRE(visible(plane, p, {0, 0, 0.003}));  // nearer than one ball
  REQUIRE_FALSE(visible(plane, p, p));
  REQUIRE_FALSE(visible(plane, p, {0.08, 0, 0}));  // they never end
  REQUIRE(visible(Points(), p, {0, 0, 1}));

  Points screened = plane;
  for (const auto& q : test::rectangle(-0.03, 0.03, -0.03, 0.03, 4000))
    screened.push_back(q + Eigen::Vector3f(0, 0, 0.1f));
  REQUIRE_FALSE(visible(screened, p, {0, 0, 0.4}));
  REQUIRE(visible(screened, p, {0, 0, 0.08}));         // the sensor stands before the screen
  REQUIRE(visible(screened, p, {0.2, 0, 0.3}));        // past its edge by 3.7 cm
  REQUIRE_FALSE(visible(screened, p, {0.1, 0, 0.3}));  // its edge is within upsilon of the line
  Parameters near;
  near.psi = 0.09;  // farther occluders do not count
  REQUIRE(visible(screened, p, {0, 0, 0.4}, near));

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
  for (const auto& q : test::rectangle(-0.05, 0.05, -0.2, 0.2, 8000)) cloud.push_back(q + Eigen::Vector3f(0, 0, 0.08f));
  const KdTree<float> tree(cloud);
  const Aabb box = box_of(cloud);
  Frontier f;
  f.index = 7;
  const Parameters p;
  REQUIRE_FALSE(sees<float>(tree, propose(f, p.view_distance), f, p, box));
  const ViewProposal moved = propose_visible(cloud, tree, f, p, box);
  REQUIRE(moved.frontier == 7);
  REQUIRE((moved.position - f.point).norm() == Approx(p.view_distance));
  REQUIRE(sees<float>(tree, moved, f, p, box));
  REQUIRE(std::abs(moved.position.x()) > std::abs(moved.position.y()));  // past the long edges of the screen
  // Between the plane (90 degrees) and the screen's edge (32 degrees) the middle is freest.
  REQUIRE(std::acos(moved.position.normalized().z()) == Approx(deg(61)).margin(deg(3)));
  Frontier clear = f;
  clear.point = {0.09, 0.0, 0.0};
  REQUIRE((propose_visible(cloud, tree, clear, p, box).position - Eigen::Vector3d(0.09, 0, 0.38)).norm() < 1e-12);
}

TEST_CASE("the visibility graph equals testing every pair", "[see]") {
  Points cloud = test::sphere({0, 0, 0}, 0.035, 4000);
  for (const auto& q : test::sphere({0.08, 0, 0}, 0.035, 4000, 2)) cloud.push_back(q);
  const KdTree<float> tree(cloud);
  const Aabb box = box_of(cloud);
  const Parameters p;
  std::vector<Frontier> frontiers;
  std::vector<ViewProposal> views;
  for (std::size_t i = 0; i < 90; ++i) {
    Frontier f;
    f.index = static_cast<Index>(i);
    f.point = cloud[i].cast<double>();
    f.normal = f.point.normalized();
    frontiers.push_back(f);
    views.push_back(propose(f, p.view_distance));
  }
  const VisibilityGraph graph = visibility_graph<float>(tree, views, frontiers, p, box);
  REQUIRE(visibility_graph<float>(tree, views, frontiers, p, box, 2).sees == graph.sees);
  int edges = 0, hidden = 0;
  for (std::size_t i = 0; i < views.size(); ++i)
    for (std::size_t j = 0; j < frontiers.size(); ++j) {
      const Eigen::Vector3d line = views[i].position - frontiers[j].point;
      const double incidence = std::acos(std::min(1.0, line.normalized().dot(frontiers[j].normal)));
      if (std::abs(incidence - p.max_incidence) < deg(1)) continue;
      // What the spheres themselves say: does the line from the point outwards pass through the other one?
      const Eigen::Vector3d o(0.08, 0, 0);
      const double t = (o - frontiers[j].point).dot(line.normalized());
      const double miss = t > 0.0 ? (frontiers[j].point + t * line.normalized() - o).norm() : 1.0;
      if (std::abs(miss - 0.035) < 0.006) continue;  // within upsilon of its edge
      const bool expected = incidence < p.max_incidence && miss > 0.035;
      CAPTURE(i, j, incidence, miss);
      REQUIRE(graph.edge(i, j) == expected);
      edges += expected ? 1 : 0;
      hidden += incidence < p.max_incidence && miss < 0.035 ? 1 : 0;
    }
  REQUIRE(edges > 200);
  REQUIRE(hidden > 20);
}

TEST_CASE("views are ranked by frontiers seen per metre, neighbours of the nearest first", "[see]") {
  std::vector<ViewProposal> views(5);
  const std::vector<double> x{1.0, 2.0, 4.0, 8.0, 3.0};
  for (std::size_t i = 0; i < 5; ++i) views[i].position.x() = x[i];
  VisibilityGraph graph;
  // 0 is nearest and sees itself and 2; 3 sees 0; 1 and 4 have nothing to do with it.
  graph.sees = {{0, 2}, {1, 2, 3, 4}, {2}, {0, 1, 2, 3, 4}, {1, 2, 3, 4}};
  const auto order = rank(views, graph, Eigen::Vector3d::Zero(), 0.1);
  REQUIRE(order == std::vector<std::size_t>{0, 3, 2, 1, 4});
  REQUIRE(views[3].visible == 5);
  REQUIRE(views[3].score == Approx(5.0 / 8.0));
  // Standing on a view does not make it infinitely good.
  rank(views, graph, Eigen::Vector3d(1, 0, 0), 0.5);
  REQUIRE(views[0].score == Approx(2.0 / 0.5));
  // Ties keep their order; nothing to rank is nothing.
  graph.sees.assign(5, {0});
  for (auto& v : views) v.position = Eigen::Vector3d::UnitY();
  REQUIRE(rank(views, graph, Eigen::Vector3d::Zero(), 0.1) == std::vector<std::size_t>{0, 1, 2, 3, 4});
  views.clear();
  REQUIRE_THROWS_AS(rank(views, graph, Eigen::Vector3d::Zero(), 0.1), InputError);
  REQUIRE(rank(views, {}, Eigen::Vector3d::Zero(), 0.1).empty());
}
