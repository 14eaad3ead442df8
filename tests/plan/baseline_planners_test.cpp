// SPDX-License-Identifier: BSD-3-Clause
// The planners that do not look at what they see: the fixed set of views, and random ones.
#include <agrisee/plan/baseline_planners.hpp>

#include <set>

#include "plan/plan_cases.hpp"

using namespace cases;

namespace {

const Aabb kVolume = box({0.3, 0.4, 0.2}, 0.1);
const Vector3d kRobot(0.0, 0.0, 0.7);
const Vector3d kFrontal(0.6, 0.8, 0.0);

/// An arm that needs a second for a unit of the change of direction. Its first three joints are the direction.
std::optional<ReachableView> pan(const ViewRequest& r, const Joints& current) {
  ReachableView view = fly_to(r);
  view.joints = Joints::Zero();
  view.joints->head<3>() = r.direction;
  view.move_time = (r.direction - current.head<3>()).norm();
  return view;
}

Joints looking(const Vector3d& direction) {
  Joints q = Joints::Zero();
  q.head<3>() = direction;
  return q;
}

Vector3d direction_of(const std::optional<ReachableView>& view) {
  REQUIRE(view);
  return view->world_T_optical.linear().col(2);
}

bool from_above(const ViewRequest& r) { return r.direction.z() < 0.1; }

/// Those of the 400 directions that pass, by the definition: the most frontal one, then always the one whose smallest
/// angle to those chosen before is the largest.
std::vector<Vector3d> well_spread(std::size_t count, const std::function<bool(const ViewRequest&)>& passes) {
  std::vector<Vector3d> all, chosen;
  for (const Vector3d& d : spread_directions(400)) {
    ViewRequest r;
    r.direction = d;
    if (passes(r)) all.push_back(d);
  }
  const auto angle = [](const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); };
  while (chosen.size() < std::min(count, all.size())) {
    std::vector<double> worth;
    for (const Vector3d& d : all) {
      double nearest = chosen.empty() ? -angle(d, kFrontal) : 10.0;
      for (const Vector3d& c : chosen) nearest = std::min(nearest, angle(d, c));
      worth.push_back(nearest);
    }
    chosen.push_back(all[static_cast<std::size_t>(std::max_element(worth.begin(), worth.end()) - worth.begin())]);
  }
  return chosen;
}

const Scan kNothing;

/// What a planner offers when it is asked twice, after it is told that this view was taken.
std::optional<ReachableView> take_next(Planner& planner, const Joints& current, const Reach& reach) {
  const auto view = planner.next(kNothing.progress(), current, reach);
  const auto again = planner.next(kNothing.progress(), current, reach);
  REQUIRE(view.has_value() == again.has_value());
  if (view) CHECK(again->world_T_optical.matrix() == view->world_T_optical.matrix());
  planner.observe(kNothing.progress());
  return view;
}

}  // namespace

TEST_CASE("fixed planner: views that cost no move are taken in the order of the farthest-point sampling") {
  Flight flight;
  flight.passes = from_above;
  FixedPlanner planner(kVolume, kRobot, 9, band());
  const auto expected = well_spread(9, from_above);
  for (std::size_t i = 0; i < 9; ++i) {
    flight.asked.clear();
    const auto view = planner.next(kNothing.progress(), Joints::Zero(), flight.reach());
    CHECK((direction_of(view) - expected[i]).norm() < 1e-12);
    CHECK((view->world_T_optical * Vector3d(0, 0, 0.4) - kVolume.center()).norm() < 1e-12);
    // 400 directions are tried once; then the first view alone, later all that are left.
    CHECK(flight.asked.size() == (i == 0 ? 401 : 9 - i));
    planner.observe(kNothing.progress());
    for (const ViewRequest& r : flight.asked) {
      CHECK(r.target == kVolume.center());
      CHECK(r.distance_min == 0.31);
      CHECK(r.distance_max == 0.47);
    }
  }
  CHECK_FALSE(planner.next(kNothing.progress(), Joints::Zero(), flight.reach()));
  CHECK(planner.stop_reason() == StopReason::max_views);
  CHECK_FALSE(planner.completeness());
  CHECK(planner.candidates().empty());
}

TEST_CASE("fixed planner: the most frontal view comes first, however far it is, then always the nearest") {
  FixedPlanner planner(kVolume, kRobot, 12, band());
  auto left = well_spread(12, [](const ViewRequest&) { return true; });
  Joints current = looking(left[1]);  // that is about opposite to frontal
  auto view = planner.next(kNothing.progress(), current, pan);
  CHECK((direction_of(view) - left[0]).norm() < 1e-12);
  CHECK(view->move_time > 1.5);
  planner.observe(kNothing.progress());
  left.erase(left.begin());
  while (!left.empty()) {
    current = *view->joints;
    view = take_next(planner, current, pan);
    REQUIRE(view);
    const auto nearest = std::min_element(left.begin(), left.end(), [&](const Vector3d& a, const Vector3d& b) {
      return (a - current.head<3>()).norm() < (b - current.head<3>()).norm();
    });
    CHECK((direction_of(view) - *nearest).norm() < 1e-12);
    left.erase(nearest);
  }
  CHECK_FALSE(planner.next(kNothing.progress(), *view->joints, pan));
}

TEST_CASE("fixed planner: fewer reachable views than asked for are all taken, and the reason says so") {
  Flight flight;
  flight.passes = [](const ViewRequest& r) { return r.direction.z() > 0.97; };
  const auto expected = well_spread(100, flight.passes);
  REQUIRE(expected.size() == 6);
  SECTION("fewer") {
    FixedPlanner planner(kVolume, kRobot, 7, band());
    for (const Vector3d& d : expected)
      CHECK((direction_of(take_next(planner, Joints::Zero(), flight.reach())) - d).norm() < 1e-12);
    CHECK_FALSE(planner.next(kNothing.progress(), Joints::Zero(), flight.reach()));
    CHECK(planner.stop_reason() == StopReason::no_reachable_view);
  }
  SECTION("as many") {
    FixedPlanner planner(kVolume, kRobot, 6, band());
    for (std::size_t i = 0; i < 6; ++i) CHECK(take_next(planner, Joints::Zero(), flight.reach()));
    CHECK_FALSE(planner.next(kNothing.progress(), Joints::Zero(), flight.reach()));
    CHECK(planner.stop_reason() == StopReason::max_views);
  }
  SECTION("none") {
    flight.passes = [](const ViewRequest&) { return false; };
    FixedPlanner planner(kVolume, kRobot, 1, band());
    CHECK_FALSE(planner.next(kNothing.progress(), Joints::Zero(), flight.reach()));
    CHECK(planner.stop_reason() == StopReason::no_reachable_view);
  }
}

TEST_CASE("fixed planner: a view that was refused is not offered again, one that became unreachable ends the scan") {
  FixedPlanner planner(kVolume, kRobot, 3, band());
  const auto first = planner.next(kNothing.progress(), Joints::Zero(), pan);
  planner.refused();
  const auto second = planner.next(kNothing.progress(), Joints::Zero(), pan);
  CHECK((direction_of(first) - direction_of(second)).norm() > 0.1);
  planner.observe(kNothing.progress());
  Flight nowhere;
  nowhere.passes = [](const ViewRequest&) { return false; };
  CHECK_FALSE(planner.next(kNothing.progress(), Joints::Zero(), nowhere.reach()));
  CHECK(nowhere.asked.size() == 1);  // the third
  CHECK(planner.stop_reason() == StopReason::no_reachable_view);
}

TEST_CASE("fixed planner: a cancelled call asks for no further view and changes nothing") {
  FixedPlanner planner(kVolume, kRobot, 4, band()), untouched(kVolume, kRobot, 4, band());
  for (const int n : {0, 7, 400}) {
    CancelledAt cancelled;
    REQUIRE(cancelled.next(planner, kNothing.progress(), Joints::Zero(), pan, n));
    CHECK(cancelled.asked == n);
  }
  for (int i = 0; i < 4; ++i) {
    const auto expected = untouched.next(kNothing.progress(), Joints::Zero(), pan);
    CHECK(direction_of(planner.next(kNothing.progress(), Joints::Zero(), pan)) == direction_of(expected));
    planner.observe(kNothing.progress());
    untouched.observe(kNothing.progress());
    if (i == 3) break;
    for (const int n : {0, 1}) {
      if (n == 1 && i == 2) continue;  // only one is left to ask for: too late
      CancelledAt cancelled;
      REQUIRE(cancelled.next(planner, kNothing.progress(), Joints::Zero(), pan, n));
      CHECK(cancelled.asked == n);
    }
  }
  CHECK_FALSE(planner.next(kNothing.progress(), Joints::Zero(), pan));
  CHECK(planner.stop_reason() == StopReason::max_views);
}

TEST_CASE("fixed and random planner: until a view is taken or refused, the same one is offered") {
  FixedPlanner fixed(kVolume, kRobot, 6, band());
  RandomPlanner random(kVolume, kRobot, band(), 42);
  for (Planner* planner : {static_cast<Planner*>(&fixed), static_cast<Planner*>(&random)}) {
    planner->refused();  // nothing was offered yet
    std::vector<Vector3d> offered;
    for (int i = 0; i < 4; ++i) {
      const Vector3d d = direction_of(planner->next(kNothing.progress(), Joints::Zero(), pan));
      CHECK(direction_of(planner->next(kNothing.progress(), Joints::Zero(), pan)) == d);
      CHECK(direction_of(planner->next(kNothing.progress(), Joints::Zero(), pan)) == d);
      for (const Vector3d& before : offered) CHECK((d - before).norm() > 1e-3);
      offered.push_back(d);
      if (i % 2 == 0) planner->refused();
      planner->observe(kNothing.progress());
      planner->observe(kNothing.progress());  // of a view that nobody asked for: uses up nothing
    }
  }
  // The two that are left, and then no more, however often it is asked.
  for (int i = 0; i < 2; ++i) CHECK(take_next(fixed, Joints::Zero(), pan));
  for (int i = 0; i < 2; ++i) CHECK_FALSE(fixed.next(kNothing.progress(), Joints::Zero(), pan));
  CHECK(fixed.stop_reason() == StopReason::max_views);
}

TEST_CASE("random planner: the first view is frontal, the others are drawn by the seed") {
  Flight flight;
  flight.passes = from_above;
  RandomPlanner planner(kVolume, kRobot, band(), 42);
  auto view = planner.next(kNothing.progress(), Joints::Zero(), flight.reach());
  CHECK((direction_of(view) - kFrontal).norm() < 1e-12);
  CHECK(flight.asked.size() == 1);
  Scan scan;
  scan.views.resize(1);
  Rng rng(42, 0x72616e64);
  for (int i = 0; i < 20; ++i) {
    planner.observe(scan.progress());
    flight.asked.clear();
    view = planner.next(scan.progress(), Joints::Zero(), flight.reach());
    std::size_t draws = 1;
    ViewRequest expected;
    while (expected.direction = rng.direction(), !from_above(expected)) ++draws;
    CHECK((direction_of(view) - expected.direction).norm() < 1e-12);
    CHECK((view->world_T_optical * Vector3d(0, 0, 0.4) - kVolume.center()).norm() < 1e-12);
    CHECK(flight.asked.size() == draws);
    CHECK(flight.asked.back().target == kVolume.center());
    CHECK(flight.asked.back().distance_min == 0.31);
  }
}

TEST_CASE("random planner: equal seeds give equal views, other seeds others") {
  Scan scan;
  scan.views.resize(1);
  std::set<double> heights;
  for (const std::uint64_t seed : {1, 2, 3}) {
    RandomPlanner a(kVolume, kRobot, band(), seed), b(kVolume, kRobot, band(), seed);
    for (int i = 0; i < 5; ++i) {
      const auto view = a.next(scan.progress(), Joints::Zero(), fly);
      CHECK(direction_of(view) == direction_of(b.next(scan.progress(), Joints::Zero(), fly)));
      heights.insert(direction_of(view).z());
      a.observe(scan.progress());
      b.observe(scan.progress());
    }
  }
  CHECK(heights.size() == 15);
}

TEST_CASE("random planner: a refused first view is replaced by a random one") {
  RandomPlanner planner(kVolume, kRobot, band(), 42);
  planner.next(kNothing.progress(), Joints::Zero(), fly);
  planner.refused();
  Rng rng(42, 0x72616e64);
  CHECK((direction_of(planner.next(kNothing.progress(), Joints::Zero(), fly)) - rng.direction()).norm() < 1e-12);
}

TEST_CASE("random planner: it gives up after 2000 draws") {
  Scan scan;
  scan.views.resize(1);
  Flight flight;
  flight.passes = [](const ViewRequest&) { return false; };
  RandomPlanner planner(kVolume, kRobot, band(), 7);
  CHECK_FALSE(planner.next(scan.progress(), Joints::Zero(), flight.reach()));
  CHECK(flight.asked.size() == 2000);
  CHECK(planner.stop_reason() == StopReason::no_reachable_view);
  // Asked again, it draws the same. Once a view was taken, the draws are used up: the next call goes on behind them.
  Rng rng(7, 0x72616e64);
  CHECK((direction_of(planner.next(scan.progress(), Joints::Zero(), fly)) - rng.direction()).norm() < 1e-12);
  rng = Rng(7, 0x72616e64);
  CHECK_FALSE(planner.next(scan.progress(), Joints::Zero(), flight.reach()));
  planner.observe(scan.progress());
  for (int i = 0; i < 2000; ++i) rng.direction();
  CHECK((direction_of(planner.next(scan.progress(), Joints::Zero(), fly)) - rng.direction()).norm() < 1e-12);
}

TEST_CASE("random planner: a cancelled call draws nothing and asks for no further view") {
  Scan scan;
  scan.views.resize(1);
  Flight nowhere;
  nowhere.passes = [](const ViewRequest&) { return false; };
  RandomPlanner planner(kVolume, kRobot, band(), 7);
  for (const int n : {0, 5}) {
    CancelledAt cancelled;
    REQUIRE(cancelled.next(planner, scan.progress(), Joints::Zero(), nowhere.reach(), n));
    CHECK(cancelled.asked == n);
  }
  Rng rng(7, 0x72616e64);
  CHECK((direction_of(planner.next(scan.progress(), Joints::Zero(), fly)) - rng.direction()).norm() < 1e-12);
}
