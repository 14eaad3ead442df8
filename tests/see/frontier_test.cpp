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
  const auto a = frontier_frame(cloud, tree, tree, i, seen_from, p);
  const auto b = frontier_frame(cloud, grid, tree, i, seen_from, p);
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
  REQUIRE(f.normal.dot(n) > std::cos(deg(15)));  // the neighbourhood lies on the seen side, so its normal tilts to it
  REQUIRE(f.direction.dot(down) > std::cos(deg(15)));
  REQUIRE(std::abs(f.boundary.y()) > std::cos(deg(3)));
  REQUIRE(points_outward(f, Eigen::Vector3d::Zero()));
  REQUIRE_FALSE(points_outward(f, 2.0 * f.point));
}

TEST_CASE("free space decides the side where the sight grazes the surface", "[see]") {
  Points cloud = test::rectangle(-0.2, 0.0, -0.1, 0.1, 6000);
  cloud.push_back(Eigen::Vector3f::Zero());
  const auto i = static_cast<Index>(cloud.size() - 1);
  for (float z = 0.008f; z < 0.03f; z += 0.002f) cloud.push_back({0.0f, 0.0f, z});  // something stands above it
  // From almost edge-on above, points are met above and none below: the free side is below.
  Parameters p;
  p.rho = 5e5;
  REQUIRE(frame_at(cloud, i, {0.4, 0.0, 0.02}, p).normal.z() < -0.9);
  // A steeper sight proves the side, whatever stands there.
  REQUIRE(frame_at(cloud, i, {0.2, 0.0, 0.3}, p).normal.z() > 0.9);
}

TEST_CASE("frontier frames of degenerate neighbourhoods are defined", "[see]") {
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
  REQUIRE_FALSE(frontier_frame(one, tree, tree, 0, Eigen::Vector3d::Zero(), Parameters()));
  REQUIRE_FALSE(frontier_frame(one, tree, tree, 0, Eigen::Vector3d::Constant(std::nan("")), Parameters()));
  const Points nan(1, Eigen::Vector3f::Constant(std::nanf("")));
  REQUIRE_FALSE(frontier_frame(nan, tree, tree, 0, eye, Parameters()));
}

TEST_CASE("directions between two, and shifted views", "[see]") {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  REQUIRE((between(x, y, 0.0) - x).norm() < 1e-12);
  REQUIRE((between(x, y, 1.0) - y).norm() < 1e-12);
  REQUIRE((between(x, y, 1.0 / 3.0) - Eigen::Vector3d(std::cos(deg(30)), std::sin(deg(30)), 0)).norm() < 1e-12);
  REQUIRE((between(x, x, 0.7) - x).norm() < 1e-12);
  const Eigen::Vector3d half = between(x, -x, 0.5);
  REQUIRE(std::abs(half.dot(x)) < 1e-12);
  REQUIRE(half.norm() == Approx(1.0));

  Frontier f;
  f.index = 4;
  f.point = {0.1, 0.0, 0.0};
  const ViewProposal last = view_of(f.point, 4, Eigen::Vector3d::UnitZ(), 0.4);
  const ViewProposal moved =
      shift_view(last, f, {0.08, 0.0, 0.0}, 2.0, 0.4);  // seen 2 cm to the left: go right by 4 cm
  REQUIRE((moved.position - f.point).norm() == Approx(0.4));
  REQUIRE((moved.position - f.point).normalized().dot(Eigen::Vector3d(0.04, 0.0, 0.4).normalized()) == Approx(1.0));
  REQUIRE((f.point - moved.position).normalized().dot(moved.direction) == Approx(1.0));
  REQUIRE((side_of(view_of(f.point, 4, x, 0.0), f.point) - x).norm() < 1e-12);  // a view on the point itself
}
