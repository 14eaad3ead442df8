// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/proposals.hpp>

#include <cmath>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace proposals_test {

namespace {

BodyParameters between(double radius_min, double radius_max) {
  BodyParameters p;
  p.radius_min = radius_min, p.radius_max = radius_max;
  return p;
}

const Eigen::Vector3d kCenter(0.1, 0.5, 0.2);

}  // namespace

TEST_CASE("the fewest points of a fruit follow from its surface and the spacing") {
  SplitParameters p;
  p.min_region = 0.03;
  CHECK(least_points(0.02, 0.002, p) == 37);  // 3 % of 400 pi
  CHECK(least_points(0.02, 0.001, p) == 150);
  CHECK(least_points(0.04, 0.002, p) == 150);
  CHECK(least_points(0.008, 0.002, p) == 12);  // 6 would be too few
  p.min_region = 0.5;
  CHECK(least_points(0.02, 0.002, p) == 628);
  CHECK(least_points(0.02, 1e-12, p) == 1000000000);
}

TEST_CASE("the lengths of the stages follow from the spacing") {
  SplitParameters p;
  p.growing_reach = 2.2, p.clustering_reach = 2.5;
  p.bodies.radius_min = 0.02;
  p.growing.smoothness = 0.3;
  const auto stages = stages_for(0.002, p);
  REQUIRE(stages);
  CHECK(stages->spacing == 0.002);
  CHECK(stages->growing.radius == Approx(0.0044));
  CHECK(stages->growing.min_size == 37);
  CHECK(stages->growing.smoothness == 0.3);
  CHECK(stages->clustering.eps == Approx(0.005));
  CHECK(stages->clustering.min_points == 8);
  CHECK(stages->min_residual == 37);
  CHECK(stages->min_cluster == 37);
  CHECK_FALSE(stages_for(0.0, p));
  CHECK_FALSE(stages_for(std::nan(""), p));
}

TEST_CASE("stages that are not adaptive take the values as they are") {
  SplitParameters p = SplitParameters::paper();
  p.growing.radius = 0.011, p.growing.min_size = 17;
  p.clustering.eps = 0.013, p.clustering.min_points = 19;
  p.min_residual = 23;
  for (const double spacing : {0.0, 0.002}) {
    const auto stages = stages_for(spacing, p);
    REQUIRE(stages);
    CHECK(stages->spacing == 0.0);
    CHECK(stages->growing.radius == 0.011);
    CHECK(stages->growing.min_size == 17);
    CHECK(stages->clustering.eps == 0.013);
    CHECK(stages->clustering.min_points == 19);
    CHECK(stages->min_residual == 23);
    CHECK(stages->min_cluster == 1);
  }
}

TEST_CASE("the likely radius is that at which most points, by solid angle, face away from the center") {
  const double low = 0.8 * 0.02, width = (1.2 * 0.05 - low) / 24;
  const auto likely = [](const Cloud& cloud) {
    return detail::likely_radius(cloud, Grid<float>(cloud, 0.006f), kCenter, 0.02, 0.05);
  };
  for (const double radius : {0.0165, 0.024, 0.03, 0.041, 0.0595}) {
    Cloud ball;
    test::add_sphere(ball, {kCenter, radius}, 0.003, test::everywhere);
    const double found = likely(ball);
    CHECK(std::abs(found - radius) < 1.01 * width);
    CHECK(std::remainder(found - low - 0.5 * width, width) == Approx(0.0).margin(1e-9));  // the middle of a bin
    // A ball of the same spacing and more points counts more if it covers more directions, not for its points alone.
    Cloud beside = ball;
    test::add_sphere(beside, {kCenter, radius < 0.03 ? 0.05 : 0.02}, 0.003,
                     [](const Eigen::Vector3d& d) { return d.z() > 0.2; });
    CHECK(likely(beside) == Approx(found));
    for (auto& n : ball.normals) n = -n;
    CHECK(likely(ball) == 0.0);  // they face the center
  }
  CHECK(likely(Cloud()) == 0.0);
  Cloud outside;  // too near and too far
  test::add_sphere(outside, {kCenter, 0.0155}, 0.003, test::everywhere);
  test::add_sphere(outside, {kCenter, 0.0605}, 0.003, test::everywhere);
  CHECK(likely(outside) == 0.0);
  Cloud turned;
  test::add_sphere(turned, {kCenter, 0.03}, 0.003, test::everywhere);
  const auto tilt = [&](double angle) {
    Cloud out = turned;
    for (auto& n : out.normals) {
      const Eigen::Vector3d d = n.cast<double>();
      n = (std::cos(angle) * d + std::sin(angle) * d.unitOrthogonal()).cast<float>();
    }
    return likely(out) > 0.0;
  };
  CHECK(tilt(std::acos(0.91)));
  CHECK_FALSE(tilt(std::acos(0.89)));
}

TEST_CASE("spheres far from the expected radii are not proposed, others within these") {
  const BodyParameters p = between(0.02, 0.04);
  std::vector<BodyCandidate> candidates;
  const auto fault = [&](double radius) { return detail::propose({kCenter, radius}, "test", p, candidates); };
  CHECK(fault(0.0) == &BodyCounts::inside_out);
  CHECK(fault(-0.03) == &BodyCounts::inside_out);
  CHECK(fault(std::nan("")) == &BodyCounts::inside_out);
  CHECK(fault(0.0099) == &BodyCounts::too_small);
  CHECK(fault(0.0801) == &BodyCounts::too_large);
  CHECK(candidates.empty());
  for (const double radius : {0.0101, 0.03, 0.0799}) CHECK(fault(radius) == nullptr);
  REQUIRE(candidates.size() == 3);
  CHECK(candidates[0].body.mean_radius() == Approx(0.02));
  CHECK(candidates[1].body.mean_radius() == Approx(0.03));
  CHECK(candidates[2].body.mean_radius() == Approx(0.04));
  CHECK(candidates[0].found_by == "test");
  CHECK(candidates[0].body.center == kCenter);
  CHECK_FALSE(candidates[0].fit);
  CHECK(candidates[0].doubt == &BodyCounts::too_small);
  CHECK(candidates[1].doubt == nullptr);
  CHECK(candidates[2].doubt == &BodyCounts::too_large);
}

TEST_CASE("a voted center that coincides with a candidate is left out") {
  Cloud cloud;
  test::add_sphere(cloud, {kCenter, 0.03}, 0.002, test::everywhere);
  SplitParameters p;
  p.bodies = between(0.02, 0.045);  // one part
  const Grid<float> grid(cloud, 0.006f);
  const auto proposed = [&](double radius_max, std::vector<BodyCandidate> candidates) {
    p.bodies.radius_max = radius_max;
    const std::size_t known = candidates.size();
    detail::propose_voted(cloud, cloud, {}, grid, *stages_for(0.002, p), p, candidates);
    std::size_t there = 0;
    for (std::size_t c = known; c < candidates.size(); ++c) {
      CHECK(candidates[c].found_by == "sphere_voting");
      there += (candidates[c].body.center - kCenter).norm() < 0.002 &&
               std::abs(candidates[c].body.mean_radius() - 0.03) < 0.003;
    }
    return there;
  };
  const auto at = [](double aside, double radius) {
    return BodyCandidate{Ellipsoid(Sphere{kCenter + Eigen::Vector3d(aside, 0, 0), radius}), "test"};
  };
  CHECK(proposed(0.045, {}) == 1);
  CHECK(proposed(0.045, {at(0.0, 0.03)}) == 0);
  CHECK(proposed(0.045, {at(0.0, 0.045)}) == 0);  // of a narrow range the center decides
  CHECK(proposed(0.045, {at(0.006, 0.03)}) == 1);
  CHECK(proposed(0.060, {}) == 2);  // a wide one is voted for in two parts, and both see it
  CHECK(proposed(0.060, {at(0.0, 0.03)}) == 0);
  CHECK(proposed(0.060, {at(0.0, 0.05)}) == 2);
}

TEST_CASE("a small surface has no more than 60 proposals, a large one more") {
  const auto proposed = [](double spacing, int columns, bool single_view = false) {
    Cloud cloud;
    for (int x = 0; x < columns; ++x)
      for (int z = 0; z < 8; ++z) test::add_sphere(cloud, {{0.1 * x, 0.5, 0.1 * z}, 0.03}, 0.01, test::everywhere);
    SplitParameters p;
    p.bodies = between(0.02, 0.045);  // one part
    std::vector<BodyCandidate> candidates;
    detail::propose_voted(cloud, cloud, {}, Grid<float>(cloud, 0.01f), *stages_for(spacing, p), p, candidates,
                          single_view);
    return candidates.size();
  };
  CHECK(proposed(0.002, 10) == 60);  // 80 balls, but together not the surface of 21 discs
  CHECK(proposed(0.01, 10) >= 80);   // 80 balls, the surface of over 140 discs
  CHECK(proposed(0.01, 60) >= 480);
  CHECK(proposed(0.01, 60, true) == 400);
}

}  // namespace proposals_test
