// SPDX-License-Identifier: BSD-3-Clause
// Evenly spread directions, level directions, and the first view of a scan.
#include <agrisee/plan/directions.hpp>

#include "plan/plan_cases.hpp"

using namespace cases;

namespace directions_test {

namespace {

/// The volume is centered at (0.3, 0.4, 0.2), in the direction (0.6, 0.8) from the robot.
const Aabb kVolume = box({0.3, 0.4, 0.2}, 0.1);
const Vector3d kRobot(0.0, 0.0, 0.7);
const Vector3d kFrontal(0.6, 0.8, 0.0);

/// The first view replaces its target and direction.
ViewRequest band() {
  ViewRequest r = cases::band();
  r.target = {9, 9, 9};
  r.direction = Vector3d::UnitZ();
  return r;
}

}  // namespace

TEST_CASE("directions: a request asks for 0.38 m by default, 0.28 to 0.55 m, and looks along y") {
  const ViewRequest r;
  CHECK(r.target == Vector3d(0, 0, 0));
  CHECK(r.direction == Vector3d(0, 1, 0));
  CHECK(r.distance == 0.38);
  CHECK(r.distance_min == 0.28);
  CHECK(r.distance_max == 0.55);
  const ReachableView view;
  CHECK(view.gain == 0.0);
  CHECK(view.move_time == 0.0);
  CHECK_FALSE(view.joints);
}

TEST_CASE("directions: heights are even, and each direction is a golden angle further around") {
  const auto four = spread_directions(4);
  REQUIRE(four.size() == 4);
  const double golden = kPi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < 4; ++i) {
    const double z = 0.75 - 0.5 * i, s = std::sqrt(1.0 - z * z);
    CHECK((at(four, i) - Vector3d(s * std::cos(golden * i), s * std::sin(golden * i), z)).norm() < 1e-12);
  }
  CHECK(spread_directions(1) == std::vector<Vector3d>{Vector3d::UnitX()});
  CHECK(spread_directions(0).empty());
  CHECK(spread_directions(-3).empty());
}

TEST_CASE("directions: many directions are unit vectors that leave no gap") {
  const auto many = spread_directions(500);
  REQUIRE(many.size() == 500);
  for (const Vector3d& d : many) CHECK(d.norm() == Approx(1.0));
  Rng rng(5);
  for (int i = 0; i < 100; ++i) {  // each stands for a disc of 0.09 rad
    const Vector3d anywhere = rng.direction();
    double nearest = kPi;
    for (const Vector3d& d : many) nearest = std::min(nearest, angle(d, anywhere));
    CHECK(nearest < 0.13);
  }
}

TEST_CASE("directions: a volume is looked at as a whole, then, if it is wide, part by part, from its middle outwards") {
  const Aabb whole{{0, 0, 0}, {0.4, 0.5, 0.3}};
  REQUIRE(parts_to_look_at(whole, 0.5).size() == 1);
  CHECK(parts_to_look_at(whole, 0.5)[0].max == whole.max);
  const Aabb row{{-1.5, 0, 0}, {1.5, 0.5, 0.3}};
  const auto parts = parts_to_look_at(row, 0.6);
  REQUIRE(parts.size() == 6);
  CHECK(parts[0].size() == row.size());
  const double middles[] = {0.0, 0.0, -0.6, 0.6, -1.2, 1.2};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    CHECK((parts[i].center() - Vector3d(middles[i], 0.25, 0.15)).norm() < 1e-12);
    if (i > 0) CHECK((parts[i].size() - Vector3d(0.6, 0.5, 0.3)).norm() < 1e-12);
  }
  // However large, no more than 27 parts, which fill it.
  for (const double size : {1.0, 7.0, 50.0}) {
    const auto many = parts_to_look_at(box({1, 2, 3}, 0.5 * size), 0.3);
    REQUIRE(many.size() <= 28);
    double sum = 0.0;
    for (std::size_t i = 1; i < many.size(); ++i) sum += many[i].size().prod();
    CHECK(sum == Approx(size * size * size));
  }
}

TEST_CASE("directions: a level direction ignores heights") {
  CHECK((level_direction({1, 1, 7}, {4, 5, -2}) - kFrontal).norm() < 1e-15);
  CHECK((level_direction({4, 5, -2}, {1, 1, 7}) + kFrontal).norm() < 1e-15);
  CHECK((frontal_direction(kVolume, kRobot) - kFrontal).norm() < 1e-15);
}

TEST_CASE("directions: straight above one another, level is y, a micrometre is enough to know better") {
  CHECK(level_direction({1, 2, 3}, {1, 2, 5}) == Vector3d(0, 1, 0));
  CHECK(level_direction({0, 0, 3}, {1e-9, 0, 5}) == Vector3d(0, 1, 0));
  CHECK(level_direction({0, 0, 3}, {1e-6, 0, 5}) == Vector3d(1, 0, 0));
}

TEST_CASE("directions: the first view is the frontal one of the volume's center") {
  Flight flight;
  const auto view = first_view(kVolume, kRobot, Joints::Zero(), flight.reach(), band());
  REQUIRE(view);
  CHECK((view->world_T_optical.translation() - (kVolume.center() - 0.4 * kFrontal)).norm() < 1e-12);
  CHECK((view->world_T_optical.linear().col(2) - kFrontal).norm() < 1e-12);
  REQUIRE(flight.asked.size() == 1);
  CHECK(flight.asked[0].target == kVolume.center());
  CHECK(flight.asked[0].distance == 0.4);
  CHECK(flight.asked[0].distance_min == 0.31);
  CHECK(flight.asked[0].distance_max == 0.47);
}

TEST_CASE("directions: where no view can be reached, 600 directions and the frontal one were tried in order") {
  Flight flight;
  flight.passes = [](const ViewRequest&) { return false; };
  CHECK_FALSE(first_view(kVolume, kRobot, Joints::Zero(), flight.reach(), band()));
  REQUIRE(flight.asked.size() == 601);
  for (std::size_t i = 1; i < 601; ++i)
    CHECK(angle(flight.asked[i - 1].direction, kFrontal) <= angle(flight.asked[i].direction, kFrontal) + 1e-12);
  auto spread = spread_directions(600);
  std::size_t found = 0;
  for (const ViewRequest& r : flight.asked) {
    found += std::count(spread.begin(), spread.end(), r.direction) == 1 ? 1u : 0u;
    CHECK(r.target == kVolume.center());
  }
  CHECK(found == 600);
}

TEST_CASE("directions: only views that can be reached are skipped") {
  Flight flight;
  // Every direction to the left of frontal is out of reach.
  flight.passes = [](const ViewRequest& r) { return kFrontal.cross(r.direction).z() <= 0.0; };
  for (const int skip : {0, 1, 5}) {
    flight.asked.clear();
    const auto view = first_view(kVolume, kRobot, Joints::Zero(), flight.reach(), band(), skip);
    REQUIRE(view);
    CHECK(std::count_if(flight.asked.begin(), flight.asked.end(), flight.passes) == skip + 1);
    CHECK(flight.passes(flight.asked.back()));
    CHECK((view->world_T_optical.linear().col(2) - flight.asked.back().direction).norm() < 1e-12);
  }
  int reachable = 0;
  for (const Vector3d& d : spread_directions(600)) reachable += kFrontal.cross(d).z() <= 0.0;
  CHECK(first_view(kVolume, kRobot, Joints::Zero(), flight.reach(), band(), reachable));
  CHECK_FALSE(first_view(kVolume, kRobot, Joints::Zero(), flight.reach(), band(), reachable + 1));
}

TEST_CASE("directions: a cancelled search for the first view asks for no further view") {
  Flight flight;
  flight.passes = [](const ViewRequest&) { return false; };
  const Cancellation stop;
  const CancellationScope scope(stop);
  const Reach cancelling = [&](const ViewRequest& r, const Joints& q) {
    if (flight.asked.size() == 6) stop.request();
    return flight.reach()(r, q);
  };
  CHECK_THROWS_AS(first_view(kVolume, kRobot, Joints::Zero(), cancelling, band()), Cancelled);
  CHECK(flight.asked.size() == 7);
}

}  // namespace directions_test
