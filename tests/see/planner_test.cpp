// SPDX-License-Identifier: BSD-3-Clause
// The controller covers what can be seen, falls back, gives up, ends, and says why.
#include <agrisee/neighbors/kdtree.hpp>
#include <agrisee/see/planner.hpp>

#include <algorithm>

#include "catch.hpp"
#include "see/shapes.hpp"

using namespace agrisee;
using namespace agrisee::see;
using test::Points;
using test::Spheres;

namespace {

const auto anywhere = [](const ViewProposal&) { return true; };
const auto nowhere = [](const ViewProposal&) { return false; };

struct Run {
  Explorer planner;
  std::vector<ViewProposal> views;
};

template <typename Reachable>
Run scan(const Spheres& scene, const Parameters& params, Reachable&& reachable, int threads = 1) {
  Run run{Explorer(params, threads), {}};
  Eigen::Vector3d sensor(0.0, -0.4, 0.0);
  run.planner.observe(scene.look(sensor, 1), sensor);
  while (const auto view = run.planner.next_view(sensor, reachable)) {
    REQUIRE(run.planner.views_taken() < params.max_views);
    REQUIRE(view->direction.norm() == Approx(1.0).margin(1e-9));
    REQUIRE(view->position.allFinite());
    run.views.push_back(*view);
    sensor = view->position;
    run.planner.observe(scene.look(sensor, 1 + run.views.size()), sensor);
  }
  return run;
}

double covered(const Explorer& planner, const Spheres& scene) {
  std::size_t seen = 0, all = 0;
  for (const auto& c : scene.centers)
    for (const auto& p : test::sphere(c, scene.radius, 1000, 99)) {
      ++all;
      seen += planner.map().grid().nearer(p, 0.004f) ? 1u : 0u;
    }
  return double(seen) / double(all);
}

}  // namespace

TEST_CASE("a sphere is covered and no frontier is left", "[see]") {
  const Spheres scene{{Eigen::Vector3d::Zero()}};
  for (Parameters params : {Parameters(), Parameters::paper()}) {
    params.max_views = 50;
    const Run run = scan(scene, params, anywhere);
    REQUIRE(run.planner.stop_reason() == StopReason::no_frontier);
    REQUIRE(covered(run.planner, scene) > 0.93);
    REQUIRE(run.views.size() >= 2);
  }
}

TEST_CASE("spheres that hide one another are covered, whatever the number of threads", "[see]") {
  const Spheres scene{{{0, 0, 0}, {0.072, 0.01, 0}, {0.03, 0.062, 0.02}, {0.02, 0.02, 0.075}}};
  Parameters params;
  params.max_views = 40;
  const Run one = scan(scene, params, anywhere);
  CAPTURE(one.views.size(), to_string(one.planner.stop_reason()));
  REQUIRE(covered(one.planner, scene) > 0.85);
  const Run two = scan(scene, params, anywhere, 2);
  REQUIRE(two.views.size() == one.views.size());
  for (std::size_t i = 0; i < one.views.size(); ++i) REQUIRE(two.views[i].position == one.views[i].position);
  REQUIRE(two.planner.cloud().points == one.planner.cloud().points);
}

TEST_CASE("a scan ends and says why", "[see]") {
  const Spheres scene{{{0, 0, 0}, {0.072, 0.01, 0}}};
  SECTION("nothing can be reached") {
    const Run run = scan(scene, Parameters(), nowhere);
    REQUIRE(run.views.empty());
    REQUIRE(run.planner.stop_reason() == StopReason::no_reachable_view);
  }
  SECTION("only the front can be reached") {
    const auto front = [](const ViewProposal& v) { return v.position.y() < -0.2; };
    Parameters params;
    params.max_views = 400;
    const Run run = scan(scene, params, front);
    for (const auto& v : run.views) REQUIRE(v.position.y() < -0.2);
    REQUIRE_FALSE(run.views.empty());
    REQUIRE(run.planner.stop_reason() == StopReason::no_reachable_view);
  }
  SECTION("the budget is used up") {
    Parameters params;
    params.max_views = 2;
    const Run run = scan(scene, params, anywhere);
    REQUIRE(run.planner.views_taken() == 2);
    REQUIRE(run.planner.stop_reason() == StopReason::max_views);
  }
  SECTION("no view promises enough") {
    Parameters params;
    params.min_gain = params.max_updates + 1;
    const Run run = scan(scene, params, anywhere);
    REQUIRE(run.views.empty());
    REQUIRE(run.planner.stop_reason() == StopReason::low_gain);
  }
  SECTION("nothing was seen") {
    Explorer planner((Parameters()));
    REQUIRE(planner.stop_reason() == StopReason::not_stopped);
    REQUIRE(planner.observe(Points(), Eigen::Vector3d::Zero()).empty());
    REQUIRE(planner.observe(Points(20, Eigen::Vector3f::Constant(std::nanf(""))), Eigen::Vector3d::Zero()).empty());
    REQUIRE_FALSE(planner.next_view(Eigen::Vector3d::Zero(), anywhere));
    REQUIRE(planner.stop_reason() == StopReason::nothing_seen);
  }
  SECTION("too little was seen to have a frontier") {
    for (const std::size_t n : {std::size_t{1}, std::size_t{2}, std::size_t{5}}) {
      Explorer planner((Parameters()));
      planner.observe(Points(n, Eigen::Vector3f::UnitX()), Eigen::Vector3d::Zero());
      REQUIRE_FALSE(planner.next_view(Eigen::Vector3d::Zero(), anywhere));
      REQUIRE(planner.stop_reason() == StopReason::no_frontier);
    }
  }
}

TEST_CASE("a frontier that stays one is looked at again, then from where it was first seen, then given up", "[see]") {
  // A strip that ends: its edge can never become core. The sensor returns the same points whatever it is told.
  Parameters params = Parameters::paper();
  params.outward_normals_only = false;  // a flat cloud has no outside
  params.max_views = 200;
  const Points strip = test::rectangle(-0.1, 0.1, -0.06, 0.06, 60000);
  const Eigen::Vector3d start(0.0, 0.0, 0.38);
  Explorer planner(params);
  planner.observe(strip, start);
  const auto first = planner.next_view(start, anywhere);
  REQUIRE(first);
  planner.observe(strip, first->position);  // nothing new: no offset to follow
  const auto second = planner.next_view(first->position, anywhere);
  REQUIRE(second);
  REQUIRE(second->frontier == first->frontier);
  const Eigen::Vector3d target = planner.cloud().points[static_cast<std::size_t>(first->frontier)].cast<double>();
  REQUIRE((second->position - target).normalized().dot((start - target).normalized()) == Approx(1.0));
  REQUIRE(planner.given_up().empty());
  planner.observe(strip, second->position);
  REQUIRE(planner.given_up() == Indices{first->frontier});
  const auto third = planner.next_view(second->position, anywhere);
  REQUIRE(third);
  REQUIRE(third->frontier != first->frontier);

  // What was added lies on one side: the next view moves to the other.
  Explorer shifting(params);
  shifting.observe(strip, start);
  const auto views = shifting.next_views(start);
  const auto count = [&](const ViewProposal& v) {
    return shifting.map().counts()[static_cast<std::size_t>(v.frontier)];
  };
  const auto a = std::min_element(views.begin(), views.end(), [&](auto& v, auto& w) { return count(v) < count(w); });
  shifting.take(*a);  // one that a point more does not make core
  const Eigen::Vector3d p = shifting.cloud().points[static_cast<std::size_t>(a->frontier)].cast<double>();
  const Eigen::Vector3d beside = p + Eigen::Vector3d(0.0, 0.0, 0.02);
  shifting.observe(Points(1, beside.cast<float>()), a->position);
  const auto b = shifting.next_view(a->position, anywhere);
  REQUIRE(b->frontier == a->frontier);
  const Eigen::Vector3d expected = a->position - p + (p - beside);
  REQUIRE((b->position - p).normalized().dot(expected.normalized()) == Approx(1.0).margin(1e-6));
  REQUIRE((b->position - p).norm() == Approx(params.view_distance));

  // Refusing the second look leads to the first view, refusing that drops the frontier.
  shifting.refuse(*b);
  const auto c = shifting.next_views(a->position);
  REQUIRE(c.front().frontier == a->frontier);
  REQUIRE((c.front().position - p).normalized().dot((start - p).normalized()) == Approx(1.0));
  shifting.refuse(c.front());
  for (const auto& v : shifting.next_views(a->position)) REQUIRE(v.frontier != a->frontier);
}

TEST_CASE("a planner that is shown the same over and over ends", "[see]") {
  Parameters params;
  params.max_views = 1000;
  params.rho = 4e6;
  params.radius = 0.02;
  const Points strip = test::rectangle(-0.03, 0.03, -0.015, 0.015, 20000);
  Explorer planner(params);
  Eigen::Vector3d sensor(0, 0, 0.38);
  planner.observe(strip, sensor);
  REQUIRE_FALSE(planner.map().of_class(PointClass::frontier).empty());
  while (const auto v = planner.next_view(sensor, anywhere)) {
    sensor = v->position;
    planner.observe(strip, sensor);
  }
  REQUIRE(planner.stop_reason() == StopReason::no_frontier);
  REQUIRE(planner.given_up().size() == planner.map().of_class(PointClass::frontier).size());
}

TEST_CASE("an unreachable view is turned towards where its point was seen from, step by step", "[see]") {
  Explorer planner((Parameters()));
  const Spheres scene{{Eigen::Vector3d::Zero()}};
  const Eigen::Vector3d sensor(0, -0.4, 0);
  planner.observe(scene.look(sensor, 1), sensor);
  const ViewProposal v = planner.next_views(sensor).front();
  const Eigen::Vector3d p = planner.cloud().points[static_cast<std::size_t>(v.frontier)].cast<double>();
  const auto angle = [&](const ViewProposal& w) {
    return std::acos((w.position - p).normalized().dot((sensor - p).normalized()));
  };
  double last = angle(v);
  for (int i = 0; i < planner.parameters().max_pulls; ++i) {
    planner.refuse(v);
    const auto views = planner.next_views(sensor);
    const auto found =
        std::find_if(views.begin(), views.end(), [&](const auto& w) { return w.frontier == v.frontier; });
    REQUIRE(found != views.end());
    REQUIRE(angle(*found) < last - deg(1));
    last = angle(*found);
  }
  planner.refuse(v);
  for (const auto& w : planner.next_views(sensor)) REQUIRE(w.frontier != v.frontier);
  planner.refuse(view_of(p, -1, Eigen::Vector3d::UnitX(), 1.0));  // none of its own: nothing happens
}

TEST_CASE("points can be filtered between views", "[see]") {
  const Spheres scene{{{0, 0, 0}, {0.072, 0.01, 0}}};
  Explorer planner((Parameters()));
  Eigen::Vector3d sensor(0, -0.4, 0);
  Rng rng(4);
  for (int i = 0; i < 8; ++i) {
    planner.observe(scene.look(sensor, static_cast<std::uint64_t>(i)), sensor);
    Indices kept;
    for (std::size_t j = 0; j < planner.cloud().size(); ++j)
      if (rng.below(10) != 0) kept.push_back(static_cast<Index>(j));
    planner.keep(kept);
    REQUIRE(planner.cloud().size() == kept.size());
    REQUIRE(planner.map().classes() == classify(planner.cloud(), planner.parameters()).classes);
    const auto view = planner.next_view(sensor, anywhere);
    if (!view) break;
    REQUIRE(planner.map().class_of(view->frontier) == PointClass::frontier);
    sensor = view->position;
  }
  planner.keep({});
  REQUIRE(planner.next_views(sensor).empty());
  REQUIRE(planner.stop_reason() == StopReason::nothing_seen);
}

TEST_CASE("the paper's test of validity leaves out frontiers that face inwards", "[see]") {
  const Spheres scene{{{0, 0, 0}, {0.072, 0.01, 0}}};
  Parameters params;
  params.outward_normals_only = true;
  Explorer planner(params);
  const Eigen::Vector3d sensor(0, -0.4, 0);
  planner.observe(scene.look(sensor, 1), sensor);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : planner.cloud().points) mean += p.cast<double>();
  mean /= double(planner.cloud().size());
  const KdTree<float> tree(planner.cloud());
  const auto views = planner.next_views(sensor);
  REQUIRE_FALSE(views.empty());
  for (const auto& v : views)
    REQUIRE(points_outward(*frontier_frame(planner.cloud(), tree, tree, v.frontier, sensor, params), mean));
}

TEST_CASE("planner, bad input", "[see]") {
  Parameters bad;
  bad.radius = -1.0;
  REQUIRE_THROWS_AS(Explorer(bad), ParameterError);
  Explorer planner((Parameters()));
  REQUIRE_THROWS_AS(planner.observe(Points(), Eigen::Vector3d::Constant(std::nan(""))), InputError);
  REQUIRE_THROWS_AS(planner.next_views(Eigen::Vector3d::Constant(std::nan(""))), InputError);
  REQUIRE_THROWS_AS(planner.keep({0}), InputError);
  REQUIRE(planner.next_views(Eigen::Vector3d::Zero()).empty());
}
