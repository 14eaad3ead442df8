// SPDX-License-Identifier: BSD-3-Clause
// The controller covers what can be seen, falls back, gives up, ends, and says why.
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
Run scan(const Spheres& scene, const Parameters& parameters, Reachable&& reachable, int threads = 1) {
  Run run{Explorer(parameters, threads), {}};
  Eigen::Vector3d sensor(0.0, -0.4, 0.0);
  run.planner.observe(scene.look(sensor, 1), sensor);
  while (const auto view = run.planner.next_view(sensor, reachable)) {
    REQUIRE(run.planner.views_taken() < parameters.max_views);
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
  for (Parameters parameters : {Parameters(), Parameters::published()}) {
    parameters.max_views = 50;
    const Run run = scan(scene, parameters, anywhere);
    REQUIRE(run.planner.stop_reason() == StopReason::no_frontier);
    REQUIRE(covered(run.planner, scene) > 0.93);
    REQUIRE(run.views.size() >= 2);
  }
}

TEST_CASE("spheres that hide one another are covered, whatever the number of threads", "[see]") {
  const Spheres scene{{{0, 0, 0}, {0.072, 0.01, 0}, {0.03, 0.062, 0.02}, {0.02, 0.02, 0.075}}};
  Parameters parameters;
  parameters.max_views = 40;
  const Run one = scan(scene, parameters, anywhere);
  CAPTURE(one.views.size(), to_string(one.planner.stop_reason()));
  REQUIRE(covered(one.planner, scene) > 0.85);
  const Run two = scan(scene, parameters, anywhere, 2);
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
    Parameters parameters;
    parameters.max_views = 400;
    const Run run = scan(scene, parameters, front);
    for (const auto& v : run.views) REQUIRE(v.position.y() < -0.2);
    REQUIRE_FALSE(run.views.empty());
    REQUIRE(run.planner.stop_reason() == StopReason::no_reachable_view);
  }
  SECTION("the budget is used up") {
    Parameters parameters;
    parameters.max_views = 2;
    const Run run = scan(scene, parameters, anywhere);
    REQUIRE(run.planner.views_taken() == 2);
    REQUIRE(run.planner.stop_reason() == StopReason::max_views);
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

namespace {

/// A strip that ends: its edge can never become core.
const Points kStrip = test::rectangle(-0.1, 0.1, -0.06, 0.06, 60000);
const Eigen::Vector3d kStart(0.0, 0.0, 0.38);

/// The frame of a frontier.
Frontier frame_of(const Explorer& planner, Index i) {
  for (const Frontier& f : planner.frontiers())
    if (f.index == i) return f;
  FAIL("no such frontier");
  return {};
}

/// A frontier that a point more does not make core: that with the fewest neighbors.
Frontier stubborn(const Explorer& planner) {
  std::optional<Frontier> best;
  for (const Frontier& f : planner.frontiers()) {
    const auto count = [&](const Frontier& g) { return planner.map().counts()[static_cast<std::size_t>(g.index)]; };
    if (!best || count(f) < count(*best)) best = f;
  }
  REQUIRE(best);
  return *best;
}

/// A point above a frontier, at a height below r: so the view adds something near it.
Points beside(const Frontier& f, float height) { return {(f.point + Eigen::Vector3d(0.0, 0.0, height)).cast<float>()}; }

}  // namespace

TEST_CASE("the controller gets the centroid of the whole observation, not of the points that were kept", "[see]") {
  Explorer planner(Parameters::published());
  planner.observe(kStrip, kStart);
  REQUIRE(planner.next_view(kStart));
  const Frontier f = stubborn(planner);
  const std::optional<ViewProposal> first = propose(f, 0.38);
  planner.take(*first);
  Points observation = kStrip;  // most of it is not new
  observation.push_back(beside(f, 0.03f)[0]);
  planner.observe(beside(f, 0.03f), observation, first->position);
  const auto second = planner.next_view(first->position, anywhere);
  REQUIRE(second);
  // The state of the controller after one adjustment, worked out apart.
  ControllerState state;
  ViewProposal expected = *first;
  const Eigen::Vector3d centroid = Observation(observation, first->position).centroid();
  REQUIRE(control_view(f, centroid, kStart, 0.38, state, expected) == ControllerAction::adjusted);
  REQUIRE(second->frontier == first->frontier);
  REQUIRE((second->position - expected.position).norm() < 1e-9);
  REQUIRE((expected.position - first->position).norm() > 0.01);
}

TEST_CASE("a view that shows nothing, or nothing near any frontier, makes its frontier an outlier", "[see]") {
  const Points shown = GENERATE(Points{}, Points{{3.0f, 3.0f, 3.0f}}, kStrip);
  Explorer planner(Parameters::published());
  planner.observe(kStrip, kStart);
  REQUIRE(planner.next_view(kStart));
  const std::optional<ViewProposal> first = propose(stubborn(planner), 0.38);
  planner.take(*first);
  planner.observe(shown, first->position);
  const auto second = planner.next_view(first->position, anywhere);
  if (shown.size() == 1) {  // a stray point is near itself, so the controller decides
    REQUIRE(planner.map().class_of(first->frontier) == PointClass::frontier);
    return;
  }
  REQUIRE(planner.map().class_of(first->frontier) == PointClass::outlier);
  REQUIRE(second);
  REQUIRE(second->frontier != first->frontier);
  // A new point near it makes it a frontier again.
  const Eigen::Vector3f p = planner.cloud().points[static_cast<std::size_t>(first->frontier)];
  planner.observe(Points{p + Eigen::Vector3f(0.0f, 0.0f, 0.0399f)}, second->position);
  REQUIRE(planner.map().class_of(first->frontier) == PointClass::frontier);
  planner.next_view(second->position);
  REQUIRE_NOTHROW(frame_of(planner, first->frontier));
}

namespace {

/// A view, and that which follows it when the centroid of what it observed lies below its frontier along the normal.
std::pair<ViewProposal, ViewProposal> after_an_offset_along_the_normal(double min_move) {
  Parameters parameters = Parameters::published();
  parameters.min_move = min_move;
  Explorer planner(parameters);
  planner.observe(kStrip, kStart);
  REQUIRE(planner.next_view(kStart));
  const Frontier f = stubborn(planner);
  const ViewProposal first = propose(f, 0.38);
  planner.take(first);
  planner.observe(beside(f, -0.03f), first.position);
  const auto second = planner.next_view(first.position, anywhere);
  REQUIRE(second);
  return {first, *second};
}

}  // namespace

TEST_CASE("an adjusted or switched view nearer to an earlier one than min_move counts as one that does not help",
          "[see]") {
  const auto [same, again] = after_an_offset_along_the_normal(0.0);  // as in SEE++
  REQUIRE(again.frontier == same.frontier);
  REQUIRE((again.position - same.position).norm() < 0.015);
  const auto [first, second] = after_an_offset_along_the_normal(0.015);
  REQUIRE(second.frontier == first.frontier);
  const Eigen::Vector3d point = first.position + 0.38 * first.direction;
  const Eigen::Vector3d switched = point + 0.38 * (kStart - point).normalized();
  REQUIRE((switched - kStart).norm() > 0.015);
  REQUIRE((second.position - switched).norm() < 1e-6);
  REQUIRE((switched - kStart).norm() < 0.05);
  const auto [view, other] = after_an_offset_along_the_normal(0.05);
  REQUIRE(other.frontier != view.frontier);
}

TEST_CASE("views nearer to an earlier one than min_move come last", "[see]") {
  const Spheres scene{{{0, 0, 0}, {0.072, 0.01, 0}, {0.03, 0.062, 0.02}, {0.02, 0.02, 0.075}}};
  const auto nearest = [&](double min_move) {
    Parameters parameters;
    parameters.min_move = min_move;
    parameters.max_views = 12;
    std::vector<Eigen::Vector3d> places{{0.0, -0.4, 0.0}};
    double least = 1.0;
    for (const ViewProposal& v : scan(scene, parameters, anywhere).views) {
      for (const auto& p : places) least = std::min(least, (v.position - p).norm());
      places.push_back(v.position);
    }
    REQUIRE(places.size() == 12);
    return least;
  };
  REQUIRE(nearest(0.0) < 0.05);
  REQUIRE(nearest(0.05) >= 0.05);
  REQUIRE_NOTHROW(nearest(10.0));  // all are too near: they are taken nevertheless
}

namespace {

/// Frames of the strip's frontiers, before and after a slope was seen beside it. That changes their neighbors.
std::vector<std::pair<Frontier, Frontier>> frames_beside_a_slope(const Parameters& parameters) {
  Explorer planner(parameters);
  planner.observe(kStrip, kStart);
  planner.next_view(kStart);
  const auto before = planner.frontiers();
  Points slope;
  for (const auto& p : test::rectangle(0.1, 0.13, -0.06, 0.06, 20000, 2))
    slope.push_back(p + Eigen::Vector3f(0.0f, 0.0f, p.x() - 0.1f));
  planner.observe(slope, kStart);
  planner.next_view(kStart);
  std::vector<std::pair<Frontier, Frontier>> out;
  for (const Frontier& f : before)
    for (const Frontier& g : planner.frontiers())
      if (f.index == g.index) out.emplace_back(f, g);
  REQUIRE(out.size() > 20);
  return out;
}

}  // namespace

TEST_CASE("without renewal the frame of a frontier is estimated once, when the point becomes one", "[see]") {
  Parameters parameters = Parameters::published();
  parameters.renew_frames = false;
  for (const auto& [f, g] : frames_beside_a_slope(parameters)) {
    REQUIRE(f.normal == g.normal);
    REQUIRE(f.direction == g.direction);
  }
}

TEST_CASE("frames are renewed for as many views as are updated", "[see]") {
  Parameters parameters = Parameters::published();
  const auto renewed = [&] {
    std::size_t n = 0;
    for (const auto& [f, g] : frames_beside_a_slope(parameters)) n += f.direction == g.direction ? 0u : 1u;
    return n;
  };
  parameters.max_updates = 1000;
  REQUIRE(renewed() > 10);
  parameters.max_updates = 1;
  REQUIRE(renewed() <= 1);
}

TEST_CASE("a renewed frame takes the proposed view along, but not one that the controller has moved", "[see]") {
  Parameters parameters = Parameters::published();
  parameters.max_updates = 1000;
  Explorer planner(parameters);
  planner.observe(kStrip, kStart);
  REQUIRE(planner.next_view(kStart));
  const Frontier f = stubborn(planner);
  const ViewProposal first = propose(f, 0.38);
  planner.take(first);
  Points shown = kStrip;
  for (const auto& p : beside(f, 0.03f)) shown.push_back(p);
  planner.observe(beside(f, 0.03f), shown, first.position);
  const auto second = planner.next_view(first.position);
  REQUIRE(second);
  REQUIRE(second->frontier == f.index);
  const Frontier renewed = frame_of(planner, f.index);
  REQUIRE(renewed.point == f.point);
  REQUIRE((second->position - propose(renewed, 0.38).position).norm() > 0.01);
  planner.refuse(*second);
  // What comes next was not moved: its view follows from its frame, or leads around what hides it.
  const auto third = planner.next_view(first.position);
  REQUIRE(third);
  const Frontier g = frame_of(planner, third->frontier);
  REQUIRE((third->position - g.point).norm() == Approx(0.38));
  REQUIRE((third->position - g.point).dot(g.normal) > 0.0);
}

TEST_CASE("a planner that is shown the same over and over ends", "[see]") {
  Parameters parameters;
  parameters.max_views = 1000;
  parameters.rho = 4e6;
  parameters.radius = 0.02;
  const Points strip = test::rectangle(-0.03, 0.03, -0.015, 0.015, 20000);
  Explorer planner(parameters);
  Eigen::Vector3d sensor(0, 0, 0.38);
  planner.observe(strip, sensor);
  REQUIRE_FALSE(planner.map().of_class(PointClass::frontier).empty());
  while (const auto v = planner.next_view(sensor, anywhere)) {
    sensor = v->position;
    planner.observe(strip, sensor);
  }
  REQUIRE(planner.stop_reason() == StopReason::no_frontier);
  REQUIRE(planner.frontiers().empty());
  REQUIRE(planner.map().of_class(PointClass::frontier).empty());
}

TEST_CASE("a view that cannot be reached: another position, or the frontier is given up", "[see]") {
  Explorer planner((Parameters()));
  const Spheres scene{{Eigen::Vector3d::Zero()}};
  const Eigen::Vector3d sensor(0, -0.4, 0);
  planner.observe(scene.look(sensor, 1), sensor);
  const ViewProposal v = *planner.next_view(sensor);
  const Eigen::Vector3d p = planner.cloud().points[static_cast<std::size_t>(v.frontier)].cast<double>();
  REQUIRE(planner.sees(v, v.position));
  REQUIRE_FALSE(planner.sees(v, p + 5.0 * (Eigen::Vector3d(-p.x(), p.y(), -p.z()) - p)));  // through the sphere
  const Eigen::Vector3d other = v.position + Eigen::Vector3d(0.0, 0.0, 1e-6);
  planner.move_view(v, other);
  const ViewProposal moved = *planner.next_view(sensor);
  REQUIRE(moved.frontier == v.frontier);
  REQUIRE(moved.position == other);
  REQUIRE((moved.direction - (p - other).normalized()).norm() < 1e-9);
  planner.refuse(moved);
  REQUIRE(planner.map().class_of(v.frontier) == PointClass::outlier);
  REQUIRE(planner.next_view(sensor)->frontier != v.frontier);
  REQUIRE_FALSE(planner.sees(v, v.position));
  planner.refuse(moved);  // no longer a frontier: nothing happens
  planner.move_view(moved, other);
  planner.refuse(view_of(p, -1, Eigen::Vector3d::UnitX(), 1.0));
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
    REQUIRE(planner.map().counts() == classify(planner.cloud(), planner.parameters()).counts);
    const auto view = planner.next_view(sensor, anywhere);
    if (!view) break;
    REQUIRE(planner.map().class_of(view->frontier) == PointClass::frontier);
    sensor = view->position;
  }
  planner.keep({});
  REQUIRE_FALSE(planner.next_view(sensor));
  REQUIRE(planner.stop_reason() == StopReason::nothing_seen);
}

TEST_CASE("the paper's test of validity leaves out frontiers that face inwards", "[see]") {
  const Spheres scene{{{0, 0, 0}, {0.072, 0.01, 0}}};
  const Eigen::Vector3d sensor(0, -0.4, 0);
  const auto proposed = [&](bool outward_only) {
    Parameters parameters;
    parameters.outward_normals_only = outward_only;
    Explorer planner(parameters);
    planner.observe(scene.look(sensor, 1), sensor);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : planner.cloud().points) mean += p.cast<double>();
    mean /= double(planner.cloud().size());
    std::size_t outward = 0, inward = 0;
    while (const auto v = planner.next_view(sensor)) {  // refuse all, so that each is proposed
      ++(points_outward(frame_of(planner, v->frontier), mean) ? outward : inward);
      planner.refuse(*v);
    }
    return std::make_pair(outward, inward);
  };
  REQUIRE(proposed(true).first > 50);
  REQUIRE(proposed(true).second == 0);
  REQUIRE(proposed(false).second > 0);
}

TEST_CASE("planner, bad input", "[see]") {
  Parameters bad;
  bad.radius = -1.0;
  REQUIRE_THROWS_AS(Explorer(bad), ParameterError);
  Explorer planner((Parameters()));
  REQUIRE_THROWS_AS(planner.observe(Points(), Eigen::Vector3d::Constant(std::nan(""))), InputError);
  REQUIRE_THROWS_AS(planner.next_view(Eigen::Vector3d::Constant(std::nan(""))), InputError);
  REQUIRE_THROWS_AS(planner.keep({0}), InputError);
  REQUIRE_FALSE(planner.next_view(Eigen::Vector3d::Zero()));
}
