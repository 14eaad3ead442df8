// SPDX-License-Identifier: BSD-3-Clause
// The planner that knows the truth takes the views of greedy_order(), one by one.
#include <agrisee/arm/limits.hpp>
#include <agrisee/arm/ur.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/study/greedy_planner.hpp>
#include <agrisee/study/simulated_scan.hpp>
#include <agrisee/study/truss.hpp>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

const Cloud kCloud;
const std::vector<sensor::SurfaceImage> kImages;
const std::vector<View> kViews;
const std::vector<Eigen::Vector3f> kAdded;
const plan::Progress kProgress{kCloud, kImages, kViews, kAdded, kAdded};

/// Six samples on a line, 1 m apart. `seen` lists for each view the samples that it sees.
struct Line {
  std::shared_ptr<Observability> observed = std::make_shared<Observability>();
  std::shared_ptr<Samples> samples = std::make_shared<Samples>();
  Aabb volume;

  explicit Line(const std::vector<std::vector<std::size_t>>& seen) {
    for (int i = 0; i < 6; ++i) {
      samples->points.emplace_back(float(i), 0.0f, 0.0f);
      samples->normals.emplace_back(0.0f, -1.0f, 0.0f);
      samples->fruit.push_back(1);
    }
    volume.extend(Eigen::Vector3d(-0.1, -0.1, -0.1));
    volume.extend(Eigen::Vector3d(0.1, 0.1, 0.1));
    if (!seen.empty()) observed->observable.assign(6, 0);
    for (std::size_t v = 0; v < seen.size(); ++v) {
      plan::ReachableView view;  // each farther from frontal, which is +y, than the one before
      view.world_T_optical = look_along({0.1 * double(v), -0.4, 0.0}, {-0.1 * double(v), 0.4, 0.0});
      observed->views.push_back(view);
      observed->seen.push_back(Bits(1, 0));
      for (const std::size_t i : seen[v]) observed->seen[v][0] |= std::uint64_t{1} << i, observed->observable[i] = 1;
    }
  }
  GreedyPlanner planner() const { return {observed, samples, volume, {0.0, -1.0, 0.0}, {}}; }
};

/// The index of the view that the planner wants next, which is its x in tenths of a metre; -1 for none.
int next_of(GreedyPlanner& planner) {
  const auto view = planner.next(kProgress, Joints::Zero(), {});
  return view ? static_cast<int>(std::lround(10.0 * view->world_T_optical.translation().x())) : -1;
}

}  // namespace

TEST_CASE("a cover counts, takes and drops") {
  const Line line({{0}, {0, 1, 2}, {2, 3, 4}, {3, 4}});
  GreedyCover cover(*line.observed, *line.samples);
  CHECK(cover.all() == 5);  // no view sees the sixth sample
  CHECK(cover.best() == std::optional<std::size_t>(1));
  CHECK(cover.take(1) == 3);
  CHECK(cover.take(1) == 0);
  CHECK(cover.left() == 2);
  CHECK(cover.covered() == Approx(0.6));
  CHECK(cover.best() == std::optional<std::size_t>(2));  // the first of equals
  cover.drop(2);
  CHECK(cover.best() == std::optional<std::size_t>(3));
  GreedyCover copy = cover;
  cover.drop(3);
  CHECK_FALSE(cover.best());
  CHECK(copy.best() == std::optional<std::size_t>(3));
  CHECK(copy.take(3) == 2);
  CHECK_FALSE(copy.best());
  CHECK(copy.covered() == 1.0);
  CHECK_THROWS_AS(cover.take(4), InputError);
  CHECK_THROWS_AS(cover.drop(4), InputError);
  CHECK_THROWS_AS(GreedyCover(*line.observed, Samples{}), InputError);
  CHECK_THROWS_AS(GreedyCover(*line.observed, *line.samples, -1.0), ParameterError);
  // With a large radius, neighbors of seen samples are covered.
  CHECK(GreedyCover(*line.observed, *line.samples, 1.01).gain(0) == 2);
}

TEST_CASE("the greedy planner starts with the frontal view, continues with the best, and says why it stops") {
  const Line line({{0}, {0, 1, 2}, {2, 3, 4}, {4}});
  GreedyPlanner planner = line.planner();
  CHECK(next_of(planner) == 0);
  CHECK(next_of(planner) == 0);  // not taken yet
  planner.observe(kProgress);
  planner.observe(kProgress);  // a view that the planner did not choose changes nothing
  CHECK(next_of(planner) == 2);
  planner.observe(kProgress);
  const auto last = planner.next(kProgress, Joints::Zero(), {});
  REQUIRE(last);
  CHECK(last->gain == 1.0);
  CHECK(next_of(planner) == 1);
  planner.observe(kProgress);
  CHECK(next_of(planner) == -1);
  CHECK(planner.stop_reason() == StopReason::no_frontier);
}

TEST_CASE("the greedy planner does not choose a refused view again") {
  const Line line({{0}, {0, 1, 2}, {2, 3, 4}, {4}});
  GreedyPlanner planner = line.planner();
  CHECK(next_of(planner) == 0);
  planner.refused();
  CHECK(next_of(planner) == 1);  // the next most frontal one, although another sees as much
  planner.observe(kProgress);
  CHECK(next_of(planner) == 2);
  planner.refused();
  CHECK(next_of(planner) == 3);
  planner.observe(kProgress);
  CHECK(next_of(planner) == -1);
  CHECK(planner.stop_reason() == StopReason::no_reachable_view);  // sample 3 is seen only by the refused view

  GreedyPlanner all = line.planner();
  for (int v = 0; v < 4; ++v) {
    CHECK(next_of(all) == v);
    all.refused();
  }
  all.refused();
  CHECK(next_of(all) == -1);
  CHECK(all.stop_reason() == StopReason::no_reachable_view);

  GreedyPlanner nothing = Line({}).planner();
  nothing.refused();
  nothing.observe(kProgress);
  CHECK(next_of(nothing) == -1);
  CHECK(nothing.stop_reason() == StopReason::no_reachable_view);
  CHECK_THROWS_AS(GreedyPlanner(nullptr, nullptr, Aabb{}, Eigen::Vector3d::Zero(), {}), InputError);
}

TEST_CASE("joints and pose of a greedy view belong together, with or without an arm") {
  Workcell cell;
  const plan::Reach reach = plan::reach_of(cell);
  plan::ViewRequest request;
  request.target = {0.0, 0.5, 0.2};
  request.direction = Eigen::Vector3d(0.3, 1.0, 0.0).normalized();
  const auto stored = reach(request, cell.start);
  REQUIRE(stored);
  Line line({{0, 1}});
  line.observed->views[0] = *stored;
  Joints far = *stored->joints;  // from here the same pose is nearer with a joint turned once around
  far[3] += stored->joints->operator[](3) > 0.0 ? -kTwoPi : kTwoPi;
  far[0] += 0.01;
  const plan::Reach armless = [&](const plan::ViewRequest&, const Joints&) {
    plan::ReachableView view = *stored;
    view.joints.reset();
    return view;
  };
  const plan::Reach nothing = [](const plan::ViewRequest&, const Joints&) { return std::nullopt; };
  for (const plan::Reach& asked : {reach, armless, nothing, plan::Reach{}})
    for (const Joints& from : {cell.start, far}) {
      GreedyPlanner planner = line.planner();
      const auto view = planner.next(kProgress, from, asked);
      REQUIRE(view);
      REQUIRE(view->joints);
      const Pose there = cell.world_T_base * arm::forward(*view->joints) * cell.tool0_T_optical;
      CHECK((there.matrix() - view->world_T_optical.matrix()).cwiseAbs().maxCoeff() < 1e-8);
      CHECK(view->world_T_optical.matrix() == stored->world_T_optical.matrix());
      CHECK(view->move_time == Approx(arm::move_time(from, *view->joints)));
      CHECK(view->move_time <= arm::move_time(from, *stored->joints));
    }
  GreedyPlanner planner = line.planner();
  CHECK(planner.next(kProgress, far, reach)->move_time < 0.1 * arm::move_time(far, *stored->joints));
  line.observed->views[0].joints.reset();  // views of a rig without an arm
  GreedyPlanner rig = line.planner();
  const auto view = rig.next(kProgress, Joints::Zero(), reach);
  REQUIRE(view);
  CHECK_FALSE(view->joints);
  CHECK(view->world_T_optical.matrix() == stored->world_T_optical.matrix());
}

TEST_CASE("a greedy view takes as long as the arm of the workcell is fast") {
  const Line line({{0, 1}});
  plan::ReachableView& view = line.observed->views[0];
  view.joints = Joints::Zero();
  Joints from = Joints::Zero();
  from[0] = 1.0;
  const arm::JointLimits slow = arm::ur_model("ur10e").limits;
  REQUIRE(arm::move_time(from, *view.joints, slow) > arm::move_time(from, *view.joints));
  GreedyPlanner planner(line.observed, line.samples, line.volume, {0.0, -1.0, 0.0}, slow);
  CHECK(planner.next(kProgress, from, {})->move_time == arm::move_time(from, *view.joints, slow));
  // Of two postures for the pose the one that this arm reaches sooner: its base is slow, its wrist is not.
  const plan::Reach other = [&](const plan::ViewRequest&, const Joints&) {
    plan::ReachableView again = view;
    again.joints = from;
    (*again.joints)[3] = 1.2 * kPi * arm::move_time(from, *view.joints);
    return again;
  };
  const auto sooner = planner.next(kProgress, from, other);
  CHECK((*sooner->joints)[3] > 0.0);
  CHECK(sooner->move_time == arm::move_time(from, *sooner->joints, slow));
  arm::JointLimits none = slow;
  none.velocity[2] = 0.0;
  CHECK_THROWS_AS(GreedyPlanner(line.observed, line.samples, line.volume, from.head<3>(), none), ParameterError);

  // The planner of a workcell knows that workcell's arm.
  TrussParameters wanted;
  wanted.total = 3;
  wanted.hidden = 0;
  Truss truss = make_truss(wanted);
  Workcell& cell = truss.workcell;
  cell.arm = arm::ur_model("ur10e");
  cell.keep_out.clear();
  LimitParameters limit;
  limit.candidates = 100;
  const auto greedy = make_greedy_planner(TracedScene(truss.scene), fruit_samples(truss.scene), cell, limit);
  const auto first = greedy->next(kProgress, cell.start, {});
  REQUIRE(first);
  CHECK(first->move_time == arm::move_time(cell.start, *first->joints, cell.arm.limits));
  CHECK(first->move_time > 1.1 * arm::move_time(cell.start, *first->joints));
}

TEST_CASE("a scan with the greedy planner takes the views of the greedy order, and all of them") {
  TrussParameters wanted;
  wanted.total = 3;
  wanted.hidden = 0;
  Truss truss = make_truss(wanted);
  truss.workcell.sensor.intrinsics = sensor::intrinsics_from_fov(128, 96, deg(70.0), deg(55.0));
  const TracedScene traced(truss.scene);
  const Samples samples = fruit_samples(truss.scene);
  LimitParameters limit;
  limit.candidates = 300;
  const Observability o = observable(traced, samples, truss.workcell, limit);
  const Eigen::Vector3d center = truss.workcell.scan_volume.center();
  const GreedyOrder order =
      greedy_order(o, samples, most_frontal(o, center, Eigen::Vector3d(center.x(), center.y(), 0.0)));
  REQUIRE(order.views.size() > 4);

  SimulationOptions options;
  options.planner = make_greedy_planner(traced, samples, truss.workcell, limit, 2);
  Parameters parameters;
  parameters.max_views = 1000;
  const ScanResult result = scan(truss.workcell, traced, parameters, std::move(options));
  CHECK(result.stop_reason == StopReason::no_frontier);
  REQUIRE(result.views.size() == order.views.size());
  for (std::size_t i = 0; i < order.views.size(); ++i) {
    const View& view = result.views[i];
    REQUIRE(view.joints);
    CHECK(view.world_T_optical.matrix() == o.views[order.views[i]].world_T_optical.matrix());
    const Pose there = truss.workcell.world_T_base * arm::forward(*view.joints) * truss.workcell.tool0_T_optical;
    CHECK((there.matrix() - view.world_T_optical.matrix()).cwiseAbs().maxCoeff() < 1e-8);
  }

  options.planner = make_greedy_planner(traced, samples, truss.workcell, limit);
  parameters.max_views = 3;
  CHECK(scan(truss.workcell, traced, parameters, std::move(options)).stop_reason == StopReason::max_views);
}
