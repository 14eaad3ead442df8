// SPDX-License-Identifier: BSD-3-Clause
// Occluders answer as all points do; the nearest views and the arcs between views equal brute force.
#include <agrisee/see/candidates.hpp>

#include "catch.hpp"
#include "see/shapes.hpp"

using namespace agrisee;
using namespace agrisee::see;
using test::Points;

namespace {

/// A candidate on the plane z = 0, seen from straight above.
Candidate above(double x, double y, Index node) {
  Candidate c;
  c.frame.index = node;
  c.frame.point = {x, y, 0.0};
  c.view = propose(c.frame, 0.38);
  c.node = node;
  return c;
}

}  // namespace

TEST_CASE("occluders: balls hold as many points as a search over all of them finds", "[see]") {
  const double upsilon = 0.005;
  const Eigen::Vector3f origin = GENERATE(Eigen::Vector3f(0.0f, 0.0f, 0.0f), Eigen::Vector3f(-9.0f, 40.0f, 3.0f),
                                          Eigen::Vector3f(1e5f, 0.0f, 0.0f), Eigen::Vector3f(0.0f, -3e9f, 0.0f));
  Occluders occluders(upsilon);
  Points points;
  Rng rng(5);
  for (const auto& p : test::sphere(Eigen::Vector3d::Zero(), 0.03, 400)) {
    points.push_back(p + origin);
    occluders.insert(points.back());
    REQUIRE(occluders.bounds().contains(points.back()));
  }
  std::size_t empty = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3f q = origin + (0.05 * rng.uniform() * rng.direction()).cast<float>();
    for (const float r : {0.0f, 0.5f * float(upsilon), float(upsilon), 3.0f * float(upsilon)}) {
      std::size_t within = 0;
      for (const auto& p : points) within += (p - q).squaredNorm() <= r * r ? 1u : 0u;
      REQUIRE(occluders.count(q, r) == within);
      REQUIRE(occluders.count(q, r, 1) == std::min<std::size_t>(within, 1));
      empty += within == 0 ? 1u : 0u;
    }
  }
  REQUIRE((empty > 4000 || origin.norm() > 1e4f));
  REQUIRE(occluders.count(Eigen::Vector3f::Constant(std::nanf("")), 0.005f) == 0);
}

TEST_CASE("occluders: some of the points stand for all, none nearer than upsilon to another", "[see]") {
  Occluders occluders(0.005);
  REQUIRE(occluders.count(Eigen::Vector3f::Zero(), 0.005f) == 0);
  const Points points = test::rectangle(-0.05, 0.05, -0.05, 0.05, 3000);
  for (const auto& p : points) occluders.insert(p);
  const auto& sparse = occluders.sparse();
  REQUIRE(sparse.size() > 100);
  REQUIRE(sparse.size() < 1000);
  for (std::size_t i = 0; i < sparse.size(); ++i) REQUIRE(sparse.count(sparse.point(i), 0.00499f) == 1);
  for (const auto& p : points) REQUIRE(sparse.count(p, 0.00501f) >= 1);
}

TEST_CASE("the nearest views, nearest first; of equally near ones the first", "[see]") {
  std::vector<Candidate> candidates;
  for (const double x : {0.3, -0.1, 0.2, 0.1, 0.0}) candidates.push_back(above(x, 0.0, 0));
  std::vector<Place> places;
  for (Candidate& c : candidates) places.push_back({c.view.position, &c});
  const Eigen::Vector3d sensor(0.0, 0.0, 0.38);
  const auto at = [&](std::size_t i) { return &candidates[i]; };
  REQUIRE(nearest_views(places, sensor, 2) == std::vector<Candidate*>{at(4), at(1)});
  REQUIRE(nearest_views(places, sensor, 5) == std::vector<Candidate*>{at(4), at(1), at(3), at(2), at(0)});
  REQUIRE(nearest_views(places, sensor, 9).size() == 5);
  REQUIRE(nearest_views(places, sensor, 0).empty());
  REQUIRE(nearest_views({}, sensor, 3).empty());
}

TEST_CASE("arcs lead to the frontiers that a view sees, among those of the tau views nearest to it", "[see]") {
  // Four frontiers in a row, and a wall between the second and the third.
  std::vector<Candidate> candidates;
  for (const double x : {-0.06, -0.02, 0.02, 0.06})
    candidates.push_back(above(x, 0.0, static_cast<Index>(candidates.size())));
  std::vector<Place> places;
  std::vector<Candidate*> all;
  Occluders occluders(0.005);
  for (Candidate& c : candidates) {
    places.push_back({c.view.position, &c});
    all.push_back(&c);
    occluders.insert(c.frame.point.cast<float>());
  }
  for (int y = -20; y <= 20; ++y)
    for (int z = 0; z <= 100; ++z) occluders.insert({0.0f, 0.004f * float(y), 0.004f * float(z)});
  see::Parameters parameters;
  for (const int threads : {1, 2}) {
    REQUIRE(arcs_from(all, places, occluders, parameters, threads, threads) ==
            std::vector<Indices>{{1}, {0}, {3}, {2}});
    parameters.max_updates = 1;  // each view only looks at its own frontier
    REQUIRE(arcs_from(all, places, occluders, parameters, threads, 1) == std::vector<Indices>(4));
    parameters.max_updates = 50;
  }
  REQUIRE(candidates[0].depth == Approx(0.01));
}

TEST_CASE("a frontier's depth is measured once a step", "[see]") {
  Candidate c = above(0.0, 0.0, 0);
  Occluders occluders(0.005);
  const see::Parameters parameters;
  occluders.insert({0.0f, 0.0f, 0.0f});
  measure_depth(c, occluders, parameters, 1);
  REQUIRE(c.depth == Approx(0.01));
  for (int z = 1; z <= 5; ++z) occluders.insert({0.0f, 0.0f, 0.004f * float(z)});
  measure_depth(c, occluders, parameters, 1);
  REQUIRE(c.depth == Approx(0.01));
  measure_depth(c, occluders, parameters, 2);
  REQUIRE(c.depth > 0.02);
  REQUIRE(sees_own(c, occluders, parameters));
  occluders.insert({0.0f, 0.0f, 0.2f});
  REQUIRE_FALSE(sees_own(c, occluders, parameters));
}

TEST_CASE("a position is near one of several, or near none", "[see]") {
  const std::vector<Eigen::Vector3d> positions{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  CHECK(near_any(positions, {1.0, 0.04, 0.0}, 0.05));
  CHECK_FALSE(near_any(positions, {0.5, 0.0, 0.0}, 0.5));  // nearer, not as near
  CHECK_FALSE(near_any(positions, {0.0, 0.0, 0.0}, 0.0));
  CHECK_FALSE(near_any({}, {0.0, 0.0, 0.0}, 1.0));
}
