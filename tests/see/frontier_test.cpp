// SPDX-License-Identifier: BSD-3-Clause
// Frontier frames where they are known, and the views that follow.
#include <agrisee/neighbors/grid.hpp>
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/see/proposal.hpp>

#include "catch.hpp"
#include "see/shapes.hpp"

using namespace agrisee;
using namespace agrisee::see;
using test::Points;

namespace {

Frontier frame_at(const Points& cloud, Index i, const Eigen::Vector3d& seen_from, const Parameters& p = {}) {
  const KdTree<float> tree(cloud);
  const Grid<float> grid(cloud, 0.02f);
  const Observation seen(cloud, seen_from);
  FrameScratch<float> scratch;
  const auto a = frontier_frame(cloud, tree, i, seen_from, seen, p, scratch);
  const auto b = frontier_frame(cloud, grid, i, seen_from, seen, p, scratch);
  REQUIRE(a);
  REQUIRE(b);
  REQUIRE(a->normal.dot(b->normal) > 1.0 - 1e-6);  // whatever the search
  REQUIRE(a->direction.dot(b->direction) > 1.0 - 1e-4);
  Eigen::Matrix3d frame;
  frame << a->direction, a->boundary, a->normal;
  REQUIRE((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm() < 1e-6);
  REQUIRE(frame.determinant() > 0.0);
  REQUIRE(a->index == i);
  REQUIRE(a->point == cloud[static_cast<std::size_t>(i)].cast<double>());
  return *a;
}

}  // namespace

TEST_CASE("frontier frame at the edge of a half-plane", "[see]") {
  Points cloud = test::rectangle(-0.2, 0.0, -0.1, 0.1, 6000);  // seen up to x = 0
  cloud.push_back(Eigen::Vector3f(0.0f, 0.01f, 0.0f));
  const auto i = static_cast<Index>(cloud.size() - 1);
  const Frontier above = frame_at(cloud, i, {0.1, 0.0, 0.4});
  REQUIRE(above.normal.z() > 0.9999);
  REQUIRE(above.direction.x() > 0.99);
  REQUIRE(std::abs(above.boundary.y()) > 0.99);
  REQUIRE(frame_at(cloud, i, {0.0, 0.0, -0.4}).normal.z() < -0.9999);
  const ViewProposal v = propose(above, 0.38);
  REQUIRE((v.position - Eigen::Vector3d(0.0, 0.01, 0.38)).norm() < 0.005);
  REQUIRE((v.position + 0.38 * v.direction - above.point).norm() < 1e-12);
  REQUIRE(v.frontier == i);
}

TEST_CASE("frontier frame at the edge of a seen cap", "[see]") {
  // A sphere seen down to 40 degrees from its pole; the frontier is at that edge in the plane y = 0.
  const double edge = deg(40), radius = 0.1;
  Points cloud;
  for (const auto& p : test::sphere({0, 0, 0}, radius, 30000))
    if (p.z() > radius * std::cos(edge)) cloud.push_back(p);
  const Eigen::Vector3d n(std::sin(edge), 0.0, std::cos(edge)), down(std::cos(edge), 0.0, -std::sin(edge));
  cloud.push_back((radius * n).cast<float>());
  const Frontier f = frame_at(cloud, static_cast<Index>(cloud.size() - 1), {0, 0, 0.5});
  REQUIRE(f.normal.dot(n) > std::cos(deg(15)));  // the neighborhood lies on the seen side, so its normal tilts to it
  REQUIRE(f.direction.dot(down) > std::cos(deg(15)));
  REQUIRE(std::abs(f.boundary.y()) > std::cos(deg(3)));
  REQUIRE(points_outward(f, Eigen::Vector3d::Zero()));
  REQUIRE_FALSE(points_outward(f, 2.0 * f.point));
}

TEST_CASE("what a view observed: centroid and free space", "[see]") {
  // A wall at z = 0, seen from 0.4 m above.
  Points wall = test::rectangle(-0.05, 0.05, -0.05, 0.05, 40000);
  wall.push_back(Eigen::Vector3f::Constant(std::nanf("")));
  const Observation seen(wall, {0.0, 0.0, 0.4});
  REQUIRE(seen.size() == 40000);
  REQUIRE(seen.centroid().norm() < 1e-3);
  REQUIRE(Observation(Points{{1, 2, 3}, {3, 2, 1}}, Eigen::Vector3d::Zero()).centroid() == Eigen::Vector3d(2, 2, 2));
  REQUIRE_FALSE(seen.hides({0.0, 0.0, 0.01}));
  REQUIRE(seen.hides({0.0, 0.0, -0.01}));
  REQUIRE(seen.hides({0.03, 0.02, -0.005}));
  REQUIRE(seen.hides({0.053, 0.0, -0.01}));       // 3 mm past its edge: within the beam
  REQUIRE_FALSE(seen.hides({0.07, 0.0, -0.01}));  // 2 cm past it
  REQUIRE_FALSE(seen.hides({0.0, 0.0, 0.4}));     // the sensor's own place
  REQUIRE_FALSE(Observation().hides({0.0, 0.0, 1.0}));
}

TEST_CASE("the free space that the last view shows decides the normal's side", "[see]") {
  Points cloud = test::rectangle(-0.2, 0.0, -0.1, 0.1, 6000);
  cloud.push_back(Eigen::Vector3f::Zero());
  const auto i = static_cast<Index>(cloud.size() - 1);
  const KdTree<float> tree(cloud);
  FrameScratch<float> scratch;
  const Parameters p;
  const auto normal = [&](const Eigen::Vector3d& first, const Points& points, const Eigen::Vector3d& sensor) {
    return frontier_frame(cloud, tree, i, first, Observation(points, sensor), p, scratch)->normal;
  };
  const Eigen::Vector3d above(0.05, 0.0, 0.4), below(0.05, 0.0, -0.4);
  REQUIRE(normal(above, cloud, above).z() > 0.99);
  REQUIRE(normal(below, cloud, above).z() > 0.99);  // whoever saw it first, this view looked through the space above
  REQUIRE(normal(above, cloud, below).z() < -0.99);
  REQUIRE(normal(below, {}, above).z() < -0.99);  // nothing seen: both sides are free
}

TEST_CASE("frontier frames of degenerate neighborhoods are defined", "[see]") {
  const Eigen::Vector3d eye(0.0, 0.3, 0.4);
  Points line;
  for (int i = 0; i < 50; ++i) line.push_back({0.001f * float(i), 0.0f, 0.0f});
  const Frontier end = frame_at(line, 49, eye);
  REQUIRE(end.direction.x() > 0.999);
  REQUIRE(end.normal.dot(Eigen::Vector3d(0, 0.6, 0.8)) > 0.999);
  const Frontier equal = frame_at(Points(10, Eigen::Vector3f::Zero()), 3, eye);
  REQUIRE(equal.normal.dot(eye.normalized()) > 0.999);
  REQUIRE(frame_at(Points(1, Eigen::Vector3f::Zero()), 0, eye).normal.dot(eye.normalized()) > 0.999);
  REQUIRE(frame_at({{0, 0, 0}, {0.01f, 0, 0}}, 0, eye).direction.x() < -0.999);

  const Points one(1, Eigen::Vector3f::Zero());
  const KdTree<float> tree(one);
  FrameScratch<float> scratch;
  const auto none = [&](const Points& cloud, const Eigen::Vector3d& from) {
    return !frontier_frame(cloud, tree, 0, from, Observation(), Parameters(), scratch);
  };
  REQUIRE(none(one, Eigen::Vector3d::Zero()));
  REQUIRE(none(one, Eigen::Vector3d::Constant(std::nan(""))));
  REQUIRE(none(Points(1, Eigen::Vector3f::Constant(std::nanf(""))), eye));
}

TEST_CASE("the side of a view", "[see]") {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), point(0.1, 0.0, 0.0);
  REQUIRE((side_of(view_of(point, 4, x, 0.4), point) - x).norm() < 1e-12);
  REQUIRE((side_of(view_of(point, 4, x, 0.0), point) - x).norm() < 1e-12);  // a view on the point itself
}
