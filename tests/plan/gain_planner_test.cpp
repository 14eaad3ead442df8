// SPDX-License-Identifier: BSD-3-Clause
// The default planner's scan: the first views, the candidates, why it ends, what it says of completeness, and calls
// that are cancelled. How it chooses among views is in gain_choice_test.cpp.
#include <agrisee/plan/gain_planner.hpp>

#include "plan/plan_cases.hpp"

using namespace cases;

namespace gain_planner_test {

namespace {

const Vector3d kFruit(0.0, 0.5, 0.2), kRobot(0.0, 0.0, 0.0);
const Aabb kVolume = box(kFruit, 0.12);

GainPlannerParameters parameters() {
  GainPlannerParameters p;
  p.candidates = 200;
  p.expected.neighborhood = 0.0;
  return p;
}

std::unique_ptr<GainPlanner> planner_of(const GainPlannerParameters& p = parameters()) {
  return std::make_unique<GainPlanner>(camera(), kVolume, kRobot, SplitParameters(), fuse::FreeSpaceParameters(), p);
}

/// A fruit whose front has been seen.
Scan half_seen() {
  Scan scan;
  test::add_sphere(scan.cloud, {kFruit, 0.035}, 0.003, [](const Vector3d& d) { return d.y() < 0.0; });
  return scan;
}

/// A row of eight voxels amidst its cloud, of which views from all sides show something.
Row open_row() {
  Row row(8, {1.0 / 16, 1.0 / 32, 0.0});
  row.parameters.candidates = 20;
  return row;
}

/// Where a planner aims while views show nothing, until it stops.
std::vector<Vector3d> empty_looks(const Aabb& volume, const std::function<bool(const ViewRequest&)>& passes) {
  GainPlanner planner(camera(), volume, kRobot, SplitParameters(), fuse::FreeSpaceParameters(), parameters());
  Scan scan;
  std::vector<Vector3d> aims;
  for (int i = 0; i < 100; ++i) {
    Flight flight;
    flight.passes = passes;
    if (!planner.next(scan.progress(), Joints::Zero(), flight.reach())) break;
    aims.push_back(flight.asked.back().target);
    scan.views.emplace_back();
    planner.observe(scan.progress());
  }
  CHECK(planner.stop_reason() == (aims.empty() ? StopReason::no_reachable_view : StopReason::nothing_seen));
  return aims;
}

}  // namespace

TEST_CASE("gain planner: while nothing is seen, four views near the front are tried") {
  GainPlannerParameters p = parameters();
  p.distance = 0.4;
  p.distance_min = 0.31;
  p.distance_max = 0.47;
  const auto planner = planner_of(p);
  ViewRequest band;
  band.distance = 0.4;
  Scan scan;
  CHECK(planner->stop_reason() == StopReason::not_stopped);
  for (int taken = 0; taken < 4; ++taken) {
    for (int refused = 0; refused < 3; ++refused) {  // since the last view
      Flight flight;
      const auto view = planner->next(scan.progress(), Joints::Zero(), flight.reach());
      const auto expected = first_view(kVolume, kRobot, Joints::Zero(), fly, band, 12 * taken + refused);
      REQUIRE(view);
      CHECK(view->world_T_optical.matrix() == expected->world_T_optical.matrix());
      CHECK(flight.asked.back().distance_min == 0.31);
      CHECK(flight.asked.back().distance_max == 0.47);
      planner->refused();
    }
    scan.views.emplace_back();
    planner->observe(scan.progress());
  }
  CHECK_FALSE(planner->next(scan.progress(), Joints::Zero(), fly));
  CHECK(planner->stop_reason() == StopReason::nothing_seen);
  CHECK_FALSE(planner->completeness());
}

TEST_CASE("gain planner: without a view near the front, nothing can be reached or nothing was seen") {
  const auto planner = planner_of();
  Scan scan;
  Flight flight;
  flight.passes = nowhere;
  CHECK_FALSE(planner->next(scan.progress(), Joints::Zero(), flight.reach()));
  CHECK(planner->stop_reason() == StopReason::no_reachable_view);
  scan.views.emplace_back();
  planner->observe(scan.progress());
  CHECK_FALSE(planner->next(scan.progress(), Joints::Zero(), flight.reach()));
  CHECK(planner->stop_reason() == StopReason::nothing_seen);
}

TEST_CASE("gain planner: while nothing is seen, every part of a wide volume is looked at") {
  const Aabb row{kFruit - Vector3d(1.0, 0.1, 0.1), kFruit + Vector3d(1.0, 0.1, 0.1)};
  const auto anywhere = [](const ViewRequest&) { return true; };
  const std::vector<Vector3d> aims = empty_looks(row, anywhere);
  REQUIRE(aims.size() >= 4);
  CHECK(aims[0] == row.center());
  double left = 0.0, right = 0.0;
  for (const Vector3d& aim : aims) {
    left = std::max(left, row.center().x() - aim.x());
    right = std::max(right, aim.x() - row.center().x());
  }
  CHECK(left > 0.7);
  CHECK(right > 0.7);
  // Only what is to the left of the middle can be reached: each part there is looked at, then the scan ends.
  const auto left_of = [&](const ViewRequest& r) { return r.target.x() < row.center().x() - 0.01; };
  const std::vector<Vector3d> reached = empty_looks(row, left_of);
  REQUIRE_FALSE(reached.empty());
  CHECK(reached.size() < aims.size());
  for (const Vector3d& aim : reached) CHECK(aim.x() < row.center().x());
}

TEST_CASE("gain planner: where the middle of the volume is out of reach, it looks at what is nearer") {
  const Aabb volume = box(kFruit, 0.2);
  const auto front = [](const ViewRequest& r) { return r.target.y() < kFruit.y() - 0.05; };
  const std::vector<Vector3d> aims = empty_looks(volume, front);
  REQUIRE_FALSE(aims.empty());
  for (const Vector3d& aim : aims) CHECK(volume.contains(aim));
  CHECK(empty_looks(volume, nowhere).empty());
}

TEST_CASE("gain planner: candidates aim and stand back by Roberts' sequence, in directions all over the sphere") {
  Row row(1, {0.0, 1.0, 0.0});
  row.scan.add_point({0.5, 2.0, 0.25});
  row.parameters.candidates = 5;
  row.parameters.spread = 0.5;
  row.parameters.distance_min = 0.3;
  row.parameters.distance_max = 0.5;
  Flight flight;
  flight.passes = nowhere;
  CHECK_FALSE(row.planner()->next(row.scan.progress(), Joints::Zero(), flight.reach()));
  REQUIRE(flight.asked.size() == 5);
  double root = 1.0;  // of x^5 = x + 1
  for (int i = 0; i < 100; ++i) root = std::pow(1.0 + root, 0.2);
  const auto directions = spread_directions(5);
  for (int i = 0; i < 5; ++i) {
    const auto part = [&](int power) { return std::fmod(i * std::pow(root, -power), 1.0); };
    const ViewRequest& r = at(flight.asked, i);
    CHECK(r.direction == at(directions, i));
    CHECK(r.target.x() == Approx(0.25 + 0.5 * 0.5 * (part(1) - 0.5)));
    CHECK(r.target.y() == Approx(1.5 + 0.5 * 1.0 * (part(2) - 0.5)));
    CHECK(r.target.z() == Approx(0.125 + 0.5 * 0.25 * (part(3) - 0.5)));
    CHECK(r.distance == Approx(0.3 + 0.2 * part(4)));
    CHECK(r.distance_min == 0.3);
    CHECK(r.distance_max == 0.5);
  }
}

TEST_CASE("gain planner: candidates are sought once, and again when the extent has moved by more than 2 cm") {
  Row row = open_row();
  row.scan.add_point({0.0, 0.04, 0.0});
  const auto planner = row.planner(64.0);
  const auto asked = [&] {
    planner->observe(row.scan.progress());
    Flight flight;
    REQUIRE(planner->next(row.scan.progress(), Joints::Zero(), flight.reach()));
    return flight.asked.size();
  };
  // The 8 best are asked for again with 6 more around each, and 6 closer to the 4 best; the one that is chosen once
  // more.
  constexpr std::size_t kAgain = 8 * 7 + 4 * 6 + 1;
  CHECK(asked() == 20 + kAgain);
  CHECK(asked() == kAgain);
  row.scan.cloud.points[1].x() -= 0.015f;
  CHECK(asked() == kAgain);
  row.scan.cloud.points[1].x() -= 0.015f;  // both moves together
  CHECK(asked() == 20 + kAgain);
  CHECK(asked() == kAgain);
  row.scan.cloud.points[0].z() += 0.019f;
  CHECK(asked() == kAgain);
  row.scan.cloud.points[0].z() += 0.002f;
  CHECK(asked() == 20 + kAgain);
}

TEST_CASE("gain planner: a half-seen fruit is looked at from behind, by the view that shows the most of all") {
  const GainPlannerParameters p = parameters();
  const auto planner = planner_of(p);
  const Scan scan = half_seen();
  planner->observe(scan.progress());
  Flight flight;
  const auto view = planner->next(scan.progress(), Joints::Zero(), flight.reach());
  REQUIRE(view);
  CHECK(view->world_T_optical.linear().col(2).y() < -0.9);
  CHECK(view->gain == gain_of(planner->model(), view->world_T_optical));
  double most = 0.0;
  for (const ViewRequest& r : flight.asked) most = std::max(most, gain_of(planner->model(), fly_to(r).world_T_optical));
  CHECK(view->gain == most);
  CHECK(view->gain > 0.3 * planner->model().area());
  CHECK((planner->model().center() - kFruit).norm() < 1e-3);

  // Those that it compared: with gain, best first, which without moves is by gain.
  const auto candidates = planner->candidates();
  REQUIRE(candidates.size() > 100);
  CHECK(candidates[0].gain == most);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    CHECK(candidates[i].gain == gain_of(planner->model(), candidates[i].world_T_optical));
    CHECK(candidates[i].gain >= p.min_gain * planner->model().area());
    if (i > 0) CHECK(candidates[i].gain <= candidates[i - 1].gain);
  }
}

TEST_CASE("gain planner: completeness counts what the candidates within reach show") {
  Flight flight;
  const int side = GENERATE(-1, 0, 1);  // where the robot can be: behind the fruit, everywhere, in front of it
  flight.passes = [&](const ViewRequest& r) { return side == 0 || side * r.direction.y() > 0.6 * std::max(side, 0); };
  const auto planner = planner_of();
  const Scan scan = half_seen();
  planner->observe(scan.progress());
  planner->next(scan.progress(), Joints::Zero(), flight.reach());
  const double seen = planner->model().covered_area() / planner->model().area();
  std::vector<char> can_be_seen(planner->model().areas().size(), 0);
  for (std::size_t i = 0; i < 200; ++i)
    if (flight.passes(flight.asked[i]))
      for (const std::uint32_t s : planner->model().shown(fly_to(flight.asked[i]).world_T_optical)) can_be_seen[s] = 1;
  const auto completeness = planner->completeness();
  REQUIRE(completeness);
  CHECK(completeness->seen == Approx(seen));
  CHECK(completeness->observable == Approx(planner->model().completeness(can_be_seen).observable));
  CHECK(seen > 0.5);
  if (side <= 0) CHECK(completeness->observable == Approx(1.0));
  if (side > 0) CHECK(completeness->observable < seen + 0.3);
}

TEST_CASE("gain planner: the scan ends when the best view promises too small a share of the known surface") {
  const Scan scan = half_seen();
  const auto next = [&](double min_gain) {
    GainPlannerParameters p = parameters();
    p.min_gain = min_gain;
    auto planner = planner_of(p);
    planner->observe(scan.progress());
    const auto view = planner->next(scan.progress(), Joints::Zero(), fly);
    CHECK(planner->candidates().empty() != view.has_value());
    if (!view) CHECK(planner->stop_reason() == StopReason::low_gain);
    return std::pair(view ? view->gain : 0.0, planner->model().area());
  };
  const auto [most, area] = next(0.1);
  CHECK(next(0.999 * most / area).first == most);
  CHECK(next(1.001 * most / area).first == 0.0);
  CHECK(GainPlannerParameters().min_gain == 0.0012);
}

TEST_CASE("gain planner: without fruit, the smallest gain is a share of a fruit of middle size") {
  Row row(8);
  row.parameters.candidates = 2;
  Script script;
  script.views = {Row::view(0, 4), Row::view(0, 3)};
  const auto reason = [&](double least_voxels) {
    row.parameters.min_gain = least_voxels * Row::kArea / Row::one_fruit();
    const auto planner = row.planner();
    const auto view = planner->next(row.scan.progress(), Joints::Zero(), script.reach());
    CHECK(script.which(view) == (view ? 0 : -1));
    return planner->stop_reason();
  };
  CHECK(reason(3.9) == StopReason::not_stopped);
  CHECK(reason(4.0) == StopReason::not_stopped);  // as much is enough
  CHECK(reason(4.1) == StopReason::low_gain);
  script.views = {Row::view(20, 4), Row::view(30, 4)};  // past the end of the row
  CHECK(reason(3.9) == StopReason::no_frontier);
  script.views = {std::nullopt, std::nullopt};
  CHECK(reason(3.9) == StopReason::no_reachable_view);
}

TEST_CASE("gain planner: a cancelled call asks for one more view at most and changes nothing") {
  Row row(10);
  Script script;
  for (int i = 0; i < 6; ++i) script.views.push_back(Row::view(0, 4 + i));
  script.other = Row::view(0, 1);
  row.parameters.candidates = 6;
  const int all = 6 + 6 * 7 + 4 * 6 + 1;
  const auto fresh = row.planner();
  const auto expected = fresh->next(row.scan.progress(), Joints::Zero(), script.reach());
  CHECK(script.asked.size() == static_cast<std::size_t>(all));
  for (int n = 0; n < all; ++n) {
    const auto planner = row.planner();
    CancelledAt cancelled;
    REQUIRE(cancelled.next(*planner, row.scan.progress(), Joints::Zero(), script.reach(), n));
    CHECK(cancelled.asked >= n);
    CHECK(cancelled.asked <= (n <= 6 ? n : n + 1));
    CHECK(planner->candidates().empty());
    CHECK_FALSE(planner->completeness());
    script.asked.clear();
    const auto view = planner->next(row.scan.progress(), Joints::Zero(), script.reach());
    // Candidates that were found before are kept if they were complete.
    CHECK(script.asked.size() == static_cast<std::size_t>(n < 6 ? all : all - 6));
    REQUIRE(view);
    CHECK(view->world_T_optical.matrix() == expected->world_T_optical.matrix());
    CHECK(planner->candidates().size() == fresh->candidates().size());
  }
  CancelledAt late;  // on being asked for the chosen view: too late
  CHECK_FALSE(late.next(*row.planner(), row.scan.progress(), Joints::Zero(), script.reach(), all));
}

TEST_CASE("gain planner: a cancelled call does not forget what the last one found of completeness") {
  const auto planner = planner_of();
  Scan scan = half_seen();
  planner->observe(scan.progress());
  planner->next(scan.progress(), Joints::Zero(), fly);
  const double before = planner->completeness()->seen;
  test::add_sphere(scan.cloud, {kFruit, 0.035}, 0.003, [](const Vector3d& d) { return d.y() >= 0.0 && d.y() < 0.1; });
  planner->observe(scan.progress());
  CancelledAt cancelled;
  REQUIRE(cancelled.next(*planner, scan.progress(), Joints::Zero(), fly, 3));
  CHECK(planner->completeness()->seen == before);
  REQUIRE(planner->next(scan.progress(), Joints::Zero(), fly));
  CHECK(planner->completeness()->seen > before + 0.02);
}

TEST_CASE("gain planner: parameters out of their range are refused") {
  GainPlannerParameters p;
  p.spread = 2.0;
  CHECK_THROWS_AS(planner_of(p), ParameterError);
  p = {};
  p.expected.voxel = 0.0;
  CHECK_THROWS_AS(planner_of(p), ParameterError);
  p = {};
  p.distance = 380.0;
  CHECK_THROWS_WITH(planner_of(p),
                    "distance must be from distance_min (0.27) to distance_max (0.55), got 380: "
                    "lengths are in metres; 380 mm are 0.38");
  p = {};
  p.distance_max = p.distance = p.distance_min;  // one distance alone
  CHECK_NOTHROW(planner_of(p));
}

}  // namespace gain_planner_test
