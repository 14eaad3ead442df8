// SPDX-License-Identifier: BSD-3-Clause
// SEE++ behind the planners' interface takes the views that see::Explorer proposes, or the nearest that can be reached.
#include <agrisee/plan/see_planner.hpp>

#include <numeric>

#include "plan/plan_cases.hpp"

using namespace cases;

namespace see_planner_test {

namespace {

const Vector3d kFruit(0.0, 0.5, 0.2), kSensor(0.0, 0.1, 0.2), kRobot(0.0, 0.0, 0.0);
const Aabb kVolume = box(kFruit, 0.1);

see::Parameters parameters() {
  see::Parameters p;
  p.radius = 0.02;
  p.max_updates = 10;
  p.view_distance = 0.4;
  return p;
}

/// A planner, and an explorer that is told the same and whose proposals are known.
struct Twins {
  explicit Twins(const see::Parameters& p = parameters()) : planner(kVolume, kRobot, p, band(), 1), explorer(p) {}

  SeePlanner planner;
  see::Explorer explorer;
  Scan scan;
  Vector3d sensor = kSensor;

  /// A view from `from` (m) that adds what it sees of the fruit, if that is not hidden from it by a cloth. If
  /// `filtered`, the 100 highest points are then removed.
  void observe(const Vector3d& from, bool cloth = false, bool filtered = false) {
    sensor = from;
    const Vector3d side = (from - kFruit).normalized();
    Cloud seen;
    test::add_sphere(seen, {kFruit, 0.035}, 0.0035, [&](const Vector3d& d) { return !cloth && d.dot(side) > 0.35; });
    scan.added = scan.observed = seen.points;
    scan.cloud.points.insert(scan.cloud.points.end(), seen.points.begin(), seen.points.end());
    scan.views.emplace_back();
    scan.views.back().world_T_optical = look_along(from, kFruit - from);
    scan.kept.reset();
    if (filtered) scan.kept.emplace();
    for (std::size_t i = 100; filtered && i < seen.size(); ++i) scan.kept->push_back(static_cast<Index>(i));
    planner.observe(scan.progress());
    explorer.observe(scan.added, from);
    if (scan.kept) explorer.keep(*scan.kept);
  }
  /// The proposal that comes next.
  see::ViewProposal proposal() const {
    const auto p = see::Explorer(explorer).next_view(sensor);
    REQUIRE(p);
    return *p;
  }
  /// The explorer's state after `planner` took a proposal from where the arm stands then.
  void take(const see::ViewProposal& p, const ReachableView& view) {
    explorer.next_view(sensor);
    explorer.move_view(p, view.world_T_optical.translation());
    explorer.take(p);
  }
  std::optional<ReachableView> next(const Reach& reach) { return planner.next(scan.progress(), Joints::Zero(), reach); }
};

/// Whether a view is what a proposal asks for.
void check_taken(const std::optional<ReachableView>& view, const see::ViewProposal& p) {
  REQUIRE(view);
  CHECK((view->world_T_optical.translation() - p.position).norm() < 1e-12);
  CHECK((view->world_T_optical.linear().col(2) - p.direction).norm() < 1e-12);
  CHECK(view->gain == p.visible);
}

}  // namespace

TEST_CASE("see planner: while nothing is seen, four views near the front are tried") {
  SeePlanner planner(kVolume, kRobot, parameters(), band(), 1);
  Scan scan;
  CHECK(planner.stop_reason() == StopReason::not_stopped);
  int refused = 0;
  for (int taken = 0; taken < 4; ++taken) {
    for (int again = 0; again < 2; ++again) {
      const auto view = planner.next(scan.progress(), Joints::Zero(), fly);
      const auto expected = first_view(kVolume, kRobot, Joints::Zero(), fly, band(), 12 * taken + refused);
      REQUIRE(view);
      CHECK(view->world_T_optical.matrix() == expected->world_T_optical.matrix());
      if (taken == 0 && again == 0) CHECK((view->world_T_optical.linear().col(2) - Vector3d::UnitY()).norm() < 1e-12);
      if (again == 0) planner.refused(), ++refused;
    }
    scan.views.emplace_back();
    planner.observe(scan.progress());
  }
  CHECK_FALSE(planner.next(scan.progress(), Joints::Zero(), fly));
  CHECK(planner.stop_reason() == StopReason::nothing_seen);
}

TEST_CASE("see planner: without a first view that can be reached the scan ends") {
  SeePlanner planner(kVolume, kRobot, parameters(), band(), 1);
  Flight flight;
  flight.passes = nowhere;
  CHECK_FALSE(planner.next(Scan().progress(), Joints::Zero(), flight.reach()));
  CHECK(flight.asked.size() == 601);
  CHECK(planner.stop_reason() == StopReason::no_reachable_view);
}

TEST_CASE("see planner: the best proposal is taken, and what becomes of it is the explorer's business") {
  Twins twins;
  twins.observe(kSensor);
  for (int i = 0; i < 4; ++i) {
    const auto proposal = twins.proposal();
    Flight flight;
    const auto view = twins.next(flight.reach());
    check_taken(view, proposal);
    REQUIRE(flight.asked.size() == 1);
    CHECK((flight.asked[0].target - proposal.position - 0.4 * proposal.direction).norm() < 1e-12);
    CHECK(flight.asked[0].distance == 0.4);
    CHECK(flight.asked[0].distance_min == 0.31);
    CHECK(flight.asked[0].distance_max == 0.47);
    twins.take(proposal, *view);
    // The second view shows nothing, so its frontier is given up; the third point of view is not where it should be.
    twins.observe(i == 2 ? Vector3d(0.3, 0.3, 0.3) : proposal.position, i == 1);
    const auto next = twins.proposal();
    if (i == 1) CHECK(next.frontier != proposal.frontier);
    CHECK((next.position - proposal.position).norm() > 1e-3);
  }
}

TEST_CASE("see planner: the explorer gets all points of the view, not only those that were added") {
  see::Parameters slow = parameters();
  slow.min_move = 0.0;  // the view moves little here
  Twins twins(slow);
  twins.observe(kSensor);
  const auto view = twins.next(fly);
  REQUIRE(view);
  twins.take(twins.proposal(), *view);
  // One point is new. The centroid of the whole observation decides where the view moves.
  const Vector3d at = view->world_T_optical.translation();
  const Vector3d p = twins.proposal().position + 0.4 * twins.proposal().direction;
  twins.scan.added = {(p + Vector3d(0.0, 0.0, 0.012)).cast<float>()};
  twins.scan.observed = twins.scan.cloud.points;
  twins.scan.views.emplace_back();
  twins.scan.views.back().world_T_optical = look_along(at, kFruit - at);
  twins.planner.observe(twins.scan.progress());
  auto with_all = twins.explorer, with_added = twins.explorer;
  with_all.observe(twins.scan.added, twins.scan.observed, at);
  with_added.observe(twins.scan.added, at);
  const auto expected = with_all.next_view(at), other = with_added.next_view(at);
  REQUIRE(expected);
  check_taken(twins.next(fly), *expected);
  CHECK((!other || (other->position - expected->position).norm() > 1e-6));
}

TEST_CASE("see planner: after a turned view the explorer goes on from where the sensor was") {
  see::Parameters slow = parameters();
  slow.min_move = 0.0;
  Twins twins(slow);
  twins.observe(kSensor);
  const auto p = twins.proposal();
  Flight flight;
  flight.passes = [&](const ViewRequest& r) { return angle(r.direction, p.direction) > deg(10); };
  const auto view = twins.next(flight.reach());
  REQUIRE(view);
  see::Explorer unmoved(twins.explorer);
  unmoved.next_view(twins.sensor);
  unmoved.take(p);
  twins.take(p, *view);
  const Vector3d at = view->world_T_optical.translation();
  twins.scan.added = {(p.position + 0.4 * p.direction + Vector3d(0.0, 0.0, 0.012)).cast<float>()};
  twins.scan.observed = twins.scan.cloud.points;
  twins.scan.views.emplace_back();
  twins.scan.views.back().world_T_optical = look_along(at, kFruit - at);
  twins.planner.observe(twins.scan.progress());
  for (see::Explorer* explorer : {&twins.explorer, &unmoved})
    explorer->observe(twins.scan.added, twins.scan.observed, at);
  const auto expected = twins.explorer.next_view(at), other = unmoved.next_view(at);
  REQUIRE(expected);
  check_taken(twins.next(fly), *expected);
  CHECK((!other || (other->position - expected->position).norm() > 1e-6));
}

TEST_CASE("see planner: points that a filter removed are no longer there") {
  Twins twins;
  twins.observe(kSensor, false, true);
  CHECK(twins.explorer.map().size() == twins.scan.added.size() - 100);
  const auto proposal = twins.proposal();
  check_taken(twins.next(fly), proposal);
  Twins unfiltered;
  unfiltered.observe(kSensor);
  CHECK((unfiltered.proposal().position - proposal.position).norm() > 1e-3);
}

TEST_CASE("see planner: a map that starts again leaves nothing of the views before") {
  // The first view shows the same fruit 3 mm aside, nearer than points may be to one another. The map drops it.
  Twins twins;
  twins.observe(kSensor);
  const std::size_t wrong = twins.scan.added.size();
  for (Eigen::Vector3f& p : twins.scan.added) p.x() += 0.003f;
  twins.scan.observed = twins.scan.added;
  twins.scan.kept.emplace(twins.scan.added.size());
  std::iota(twins.scan.kept->begin(), twins.scan.kept->end(), static_cast<Index>(wrong));
  twins.scan.views.push_back(twins.scan.views.back());
  twins.planner.observe(twins.scan.progress());

  see::Explorer fresh(parameters());
  fresh.observe(twins.scan.added, kSensor);
  const auto expected = fresh.next_view(kSensor);
  REQUIRE(expected);
  check_taken(twins.next(fly), *expected);
}

TEST_CASE("see planner: points that the explorer dropped do not count among those that a filter keeps") {
  Twins twins, plain;
  for (Twins* t : {&twins, &plain}) t->observe(kSensor);
  const std::size_t first = twins.scan.added.size();
  // The same view twice: the map has all points twice, the explorer once. A filter keeps all but the last of the first.
  twins.scan.kept.emplace();
  for (std::size_t i = 0; i < 2 * first; ++i)
    if (i + 1 != first) twins.scan.kept->push_back(static_cast<Index>(i));
  twins.scan.views.push_back(twins.scan.views.back());
  REQUIRE_NOTHROW(twins.planner.observe(twins.scan.progress()));

  Indices kept(first - 1);
  std::iota(kept.begin(), kept.end(), 0);
  plain.explorer.observe(twins.scan.added, kSensor);
  plain.explorer.keep(kept);
  const auto expected = plain.explorer.next_view(kSensor);
  REQUIRE(expected);
  check_taken(twins.next(fly), *expected);
}

TEST_CASE("see planner: a proposal out of reach is turned in steps of 9 degrees, at most by 45, to the shortest move") {
  const double limit = GENERATE(0.1, 10.0, 20.0, 30.0, 40.0);
  Twins twins;
  twins.observe(kSensor);
  const see::ViewProposal p = twins.proposal();
  Flight flight;
  flight.passes = [&](const ViewRequest& r) { return angle(r.direction, p.direction) > deg(limit); };
  const Vector3d preferred = Vector3d(1, 2, 3).normalized();
  const Reach reach = [&](const ViewRequest& r, const Joints& q) {
    auto view = flight.reach()(r, q);
    if (view) view->move_time = angle(r.direction, preferred);
    return view;
  };
  const auto view = twins.next(reach);
  REQUIRE(view);
  const int steps = static_cast<int>(limit / 9.0) + 1;
  REQUIRE(flight.asked.size() == static_cast<std::size_t>(1 + 8 * steps));
  // Of the turned views that see the frontier, that with the shortest move.
  see::Explorer explorer(twins.explorer);
  REQUIRE(explorer.next_view(twins.sensor));
  std::vector<Vector3d> around;
  for (std::size_t i = 1; i < flight.asked.size(); ++i) {
    const ViewRequest& r = flight.asked[i];
    CHECK((r.target - p.position - 0.4 * p.direction).norm() < 1e-12);
    CHECK(r.direction.norm() == Approx(1.0));
    const double turn = deg(9.0 * static_cast<double>((i - 1) / 8 + 1));
    CHECK(angle(r.direction, p.direction) == Approx(turn));
    if ((i - 1) % 8 > 0)  // evenly around: a chord of 45 degrees on the circle
      CHECK((r.direction - flight.asked[i - 1].direction).norm() == Approx(2.0 * std::sin(turn) * std::sin(deg(22.5))));
    if ((i - 1) % 8 > 1) CHECK((r.direction - flight.asked[i - 2].direction).norm() > 1.2 * std::sin(turn));
    if (angle(r.direction, p.direction) > deg(limit) && explorer.sees(p, r.target - 0.4 * r.direction))
      around.push_back(r.direction);
  }
  REQUIRE_FALSE(around.empty());
  const auto best = std::min_element(around.begin(), around.end(), [&](const Vector3d& a, const Vector3d& b) {
    return angle(a, preferred) < angle(b, preferred);
  });
  CHECK((view->world_T_optical.linear().col(2) - *best).norm() < 1e-12);
  CHECK((view->target - p.position - 0.4 * p.direction).norm() < 1e-12);
  CHECK(view->gain == p.visible);
  // From now on that is the frontier's view, from which the controller goes on.
  twins.planner.refused();
}

TEST_CASE("see planner: of turned views with equal moves the first is taken") {
  Twins twins;
  twins.observe(kSensor);
  Flight flight;
  flight.passes = [&](const ViewRequest&) { return flight.asked.size() > 1; };
  const auto view = twins.next(flight.reach());
  REQUIRE(view);
  REQUIRE(flight.asked.size() == 9);
  CHECK((view->world_T_optical.linear().col(2) - flight.asked[1].direction).norm() < 1e-12);
}

TEST_CASE("see planner: a proposal that cannot even be turned is refused, and the next is tried") {
  Twins twins;
  twins.observe(kSensor);
  const double height = kFruit.z() + GENERATE(-0.02, 0.0, 0.02);
  std::size_t tried = 0;
  const auto expected = twins.explorer.next_view(twins.sensor, [&](const see::ViewProposal& p) {
    ++tried;
    return (p.position + 0.4 * p.direction).z() > height;
  });
  REQUIRE(expected);
  Flight flight;
  flight.passes = [&](const ViewRequest& r) { return r.target.z() > height; };
  check_taken(twins.next(flight.reach()), *expected);
  CHECK(flight.asked.size() == 41 * (tried - 1) + 1);
}

TEST_CASE("see planner: when everything is out of reach, all proposals are refused and the reason says so") {
  Twins twins;
  twins.observe(kSensor);
  std::size_t tried = 0;
  CHECK_FALSE(twins.explorer.next_view(twins.sensor, [&](const see::ViewProposal&) { return ++tried == 0; }));
  Flight flight;
  flight.passes = nowhere;
  CHECK_FALSE(twins.next(flight.reach()));
  CHECK(flight.asked.size() == 41 * tried);
  CHECK(twins.planner.stop_reason() == StopReason::no_reachable_view);
}

TEST_CASE("see planner: a refused view is not returned again") {
  Twins twins;
  twins.observe(kSensor);
  for (int i = 0; i < 6; ++i) {
    const auto proposal = twins.proposal();
    const auto view = twins.next(fly);
    check_taken(view, proposal);
    twins.planner.refused();
    twins.take(proposal, *view);
    twins.explorer.refuse(proposal);
    CHECK(twins.proposal().frontier != proposal.frontier);
  }
}

TEST_CASE("see planner: until a view is taken or refused, the same one is offered") {
  Twins twins;
  twins.observe(kSensor);
  const Vector3d across = Vector3d(0.3, 0.5, 0.2).normalized();
  Flight flight;
  flight.passes = [&](const ViewRequest& r) { return std::fmod(angle(r.direction, across), deg(24)) < deg(12); };
  const Reach nearer = [&](const ViewRequest& r, const Joints& q) {
    ViewRequest other = r;
    other.distance = 0.35;
    return flight.reach()(other, q);
  };
  std::size_t most = 0;
  for (int i = 0; i < 6; ++i) {
    flight.asked.clear();
    const auto view = twins.next(nearer);
    most = std::max(most, flight.asked.size());
    REQUIRE(view);
    for (int again = 0; again < 2; ++again) {
      const auto same = twins.next(nearer);
      REQUIRE(same);
      CHECK(same->world_T_optical.matrix() == view->world_T_optical.matrix());
      CHECK(same->gain == view->gain);
    }
    if (i % 2 == 0) twins.planner.refused();
    if (i % 2 == 1) twins.observe(view->world_T_optical.translation());
  }
  CHECK(most > 1);  // a proposal was turned
}

TEST_CASE("see planner: a cancelled call asks for one proposal at most and leaves the others as they were") {
  Twins twins;
  twins.observe(kSensor);
  const auto proposal = twins.proposal();
  Flight flight;
  flight.passes = nowhere;
  for (const int n : {0, 3, 41 + 3, 3 * 41 + 1}) {
    CancelledAt cancelled;
    REQUIRE(cancelled.next(twins.planner, twins.scan.progress(), Joints::Zero(), flight.reach(), n));
    CHECK(cancelled.asked == (n + 40) / 41 * 41);
  }
  const auto view = twins.next(fly);
  check_taken(view, proposal);
  twins.planner.refused();
  twins.take(proposal, *view);
  twins.explorer.refuse(proposal);
  check_taken(twins.next(fly), twins.proposal());
}

TEST_CASE("see planner: a reach that throws leaves the proposals as they were") {
  Twins twins;
  twins.observe(kSensor);
  const auto expected = twins.proposal();
  int asked = 0;
  const Reach offline = [&asked](const ViewRequest&, const Joints&) -> std::optional<ReachableView> {
    if (++asked > 41) throw std::runtime_error("offline");  // the first proposal, and 40 turned views
    return std::nullopt;
  };
  CHECK_THROWS_AS(twins.next(offline), std::runtime_error);
  check_taken(twins.next(fly), expected);
}

}  // namespace see_planner_test
