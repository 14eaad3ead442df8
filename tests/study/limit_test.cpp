// SPDX-License-Identifier: BSD-3-Clause
// What can be observed from known poses and by the arm, and in how few views.
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/study/greedy.hpp>
#include <agrisee/study/truss.hpp>
#include <agrisee/study/truss_mesh.hpp>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

Scene one_ball() {
  FruitShape ball;
  ball.equatorial = ball.polar = 0.035;
  ball.lobe_amplitude = ball.dimple_depth = 0.0;
  return {{{1, ObjectClass::fruit, transformed(fruit_mesh(ball), pose_from_xyz_rpy({0.0, 0.5, 0.2}, {0, 0, 0}))}}};
}

plan::ReachableView look(const Eigen::Vector3d& from) {
  plan::ReachableView view;
  view.target = {0.0, 0.5, 0.2};
  view.world_T_optical = look_along(from, view.target - from);
  return view;
}

double count(const Flags& flags) {
  double n = 0.0;
  for (const auto f : flags) n += f;
  return n;
}

}  // namespace

TEST_CASE("the union and the greedy order of known views") {
  const Scene scene = one_ball();
  const TracedScene traced(scene);
  const Samples samples = fruit_samples(scene);
  // From the front, a little beside it, from above, and from far away.
  const std::vector<plan::ReachableView> views{look({0.0, 0.1, 0.2}), look({0.02, 0.1, 0.2}), look({0.0, 0.5, 0.6}),
                                               look({0.0, 0.1, 9.9})};
  const Observability o = observe_from(traced, samples, sensor::l515(), views);
  REQUIRE(o.views.size() == 3);  // the last is out of range
  Flags any(samples.size(), 0);
  for (std::size_t v = 0; v < 3; ++v) {
    const Flags flags = visible_to(traced, samples, views[v].world_T_optical, sensor::l515());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      REQUIRE(o.sees(v, i) == bool(flags[i]));
      any[i] |= flags[i];
    }
  }
  CHECK(o.observable == any);
  const Observability threaded = observe_from(traced, samples, sensor::l515(), views, 3);
  CHECK(threaded.seen == o.seen);

  CHECK(most_frontal(o, {0.0, 0.5, 0.2}, {0, 1, 0}) == 0);
  CHECK(most_frontal(o, {0.0, 0.5, 0.2}, {0, 0, -1}) == 2);
  for (const auto first : {std::optional<std::size_t>(), std::optional<std::size_t>(1)}) {
    const GreedyOrder order = greedy_order(o, samples, first);
    REQUIRE(order.views.size() >= 2);
    if (first) {
      CHECK(order.views[0] == 1);
      CHECK(order.views[1] == 2);  // from another side, so it adds most
    }
    CHECK(order.covered.back() == 1.0);
    // What the first view covers, by brute force.
    double covered = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!any[i]) continue;
      for (std::size_t j = 0; j < samples.size(); ++j)
        if (o.sees(order.views[0], j) && (samples.points[i] - samples.points[j]).norm() <= 0.005f) {
          covered += 1.0;
          break;
        }
    }
    CHECK(order.covered[0] == Approx(covered / count(any)));
    CHECK(order.views_for(order.covered[0]) == std::optional<std::size_t>(1));
    CHECK_FALSE(order.views_for(1.1));
  }
  CHECK_THROWS_AS(greedy_order(o, samples, 3), InputError);
  CHECK_THROWS_AS(greedy_order(o, samples, std::nullopt, 0.0), ParameterError);
}

TEST_CASE("the arm cannot see about a third of a truss") {
  TrussParameters parameters;
  parameters.seed = 3;
  const Truss truss = make_truss(parameters);
  const TracedScene traced(truss.scene);
  const Samples samples = fruit_samples(truss.scene);
  LimitParameters limit;
  limit.candidates = 2000;
  const Observability o = observable(traced, samples, truss.workcell, limit);
  REQUIRE(o.views.size() > 100);
  const double all = count(o.observable) / double(samples.size());
  CHECK(all > 0.6);
  CHECK(all < 0.8);
  for (const TrueFruit& fruit : truss.truth.fruits) CHECK(share(samples, o.observable, fruit.id) > 0.5);
  for (const plan::ReachableView& view : o.views) {
    REQUIRE(view.joints);
    REQUIRE(view.world_T_optical.translation().y() < 0.545);  // on the robot's side
    for (const KeepOut& space : truss.workcell.keep_out)
      REQUIRE(distance(space, view.world_T_optical.translation()) > 0.0);
  }
  const GreedyOrder order = greedy_order(o, samples, most_frontal(o, parameters.center, Eigen::Vector3d::UnitY()));
  REQUIRE(order.views_for(0.98));
  CHECK(*order.views_for(0.9) >= 3);
  CHECK(*order.views_for(0.9) <= 7);
  CHECK(*order.views_for(0.98) <= 14);
  CHECK(std::is_sorted(order.covered.begin(), order.covered.end()));

  const Observability threaded = observable(traced, samples, truss.workcell, limit, 2);
  CHECK(threaded.seen == o.seen);
  CHECK(threaded.observable == o.observable);
}

TEST_CASE("an arm that reaches nothing, or a scene without fruit, gives no views") {
  const Scene scene = one_ball();
  const TracedScene traced(scene);
  const Samples samples = fruit_samples(scene);
  LimitParameters parameters;
  parameters.candidates = 200;
  Workcell cell;
  cell.world_T_base.translation().x() = 3.0;
  const Observability o = observable(traced, samples, cell, parameters);
  CHECK(o.views.empty());
  CHECK(o.observable.empty());
  CHECK(greedy_order(o, samples).views.empty());
  CHECK_THROWS_AS(most_frontal(o, {0, 0, 0}, {0, 1, 0}), InputError);
  CHECK(observable(TracedScene(Scene{}), Samples{}, Workcell{}, parameters).views.empty());
  CHECK_THROWS_AS(reachable_views(plan::reach_of(Workcell{}), Joints::Zero(), Aabb{}, parameters), InputError);
  parameters.candidates = 0;
  CHECK_THROWS_AS(observable(traced, samples, cell, parameters), ParameterError);
  parameters = {};
  parameters.distance_max = 0.1;
  CHECK_THROWS_AS(observable(traced, samples, cell, parameters), ParameterError);
}
