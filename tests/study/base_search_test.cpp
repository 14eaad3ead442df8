// SPDX-License-Identifier: BSD-3-Clause
// Where to put the robot: beside a wall, not inside solids, and together with what it stands on.
#include <agrisee/study/base_search.hpp>
#include <agrisee/study/greedy.hpp>
#include <agrisee/study/truss_mesh.hpp>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

constexpr float kFar = 3.0f;

/// Two balls side by side at the height of the arm's shoulder.
Scene two_balls() {
  FruitShape ball;
  ball.equatorial = ball.polar = 0.035;
  ball.lobe_amplitude = ball.dimple_depth = 0.0;
  Scene scene;
  for (const int id : {1, 2})
    scene.objects.push_back({id, ObjectClass::fruit,
                             transformed(fruit_mesh(ball), pose_from_xyz_rpy({0.1 * id - 0.15, 0.5, 0.2}, {0, 0, 0}))});
  return scene;
}

/// A wall in the plane x = 0.15 between the balls and everything beyond.
Object wall() {
  Mesh mesh;
  for (const float y : {-kFar, kFar})
    for (const float z : {-kFar, kFar}) mesh.vertices.push_back({0.15f, y, z});
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  return {0, ObjectClass::other, mesh};
}

Workcell cell_of(const Eigen::Vector3d& base) {
  Workcell cell;
  cell.world_T_base.translation() = base;
  cell.scan_volume.extend(Eigen::Vector3d(-0.12, 0.42, 0.12));
  cell.scan_volume.extend(Eigen::Vector3d(0.12, 0.58, 0.28));
  return cell;
}

BaseSearchParameters quick(double range, double step) {
  BaseSearchParameters parameters;
  parameters.range = range;
  parameters.step = step;
  parameters.limit.candidates = 250;
  return parameters;
}

const BasePlace& present(const std::vector<BasePlace>& places) {
  const auto at = std::find_if(places.begin(), places.end(), [](const BasePlace& p) { return p.present; });
  REQUIRE(at != places.end());
  return *at;
}

const BasePlace& at(const std::vector<BasePlace>& places, double x, double y) {
  const auto found = std::find_if(places.begin(), places.end(), [&](const BasePlace& p) {
    return std::hypot(p.base.x() - x, p.base.y() - y) < 1e-9;
  });
  REQUIRE(found != places.end());
  return *found;
}

}  // namespace

TEST_CASE("the present place has the figures of observable, and the best comes first") {
  const Scene scene = two_balls();
  const TracedScene traced(scene);
  const Samples samples = fruit_samples(scene);
  const Workcell cell = cell_of({0.0, 0.0, 0.0});
  const BaseSearchParameters parameters = quick(0.29, 0.2);  // only whole steps are taken
  const std::vector<BasePlace> places = base_search(traced, samples, cell, parameters);
  REQUIRE(places.size() == 9);
  for (std::size_t i = 1; i < places.size(); ++i) CHECK(places[i - 1].observable >= places[i].observable);
  CHECK(places.front().observable > places.back().observable);

  const Observability o = observable(traced, samples, cell, parameters.limit);
  const BasePlace& here = present(places);
  CHECK(here.base == Eigen::Vector3d::Zero());
  CHECK(here.poses == o.views.size());
  CHECK(here.observable > 0.3);
  CHECK(here.observable == share(samples, o.observable));
  CHECK(here.least == std::min(share(samples, o.observable, 1), share(samples, o.observable, 2)));
  const std::size_t first = most_frontal(o, cell.scan_volume.center(), Eigen::Vector3d::UnitY());
  CHECK(here.views == greedy_order(o, samples, first).views_for(0.95));

  const std::vector<BasePlace> threaded = base_search(traced, samples, cell, parameters, 3);
  REQUIRE(threaded.size() == places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    CHECK(threaded[i].base == places[i].base);
    CHECK(threaded[i].observable == places[i].observable);
    CHECK(threaded[i].least == places[i].least);
    CHECK(threaded[i].views == places[i].views);
  }
}

TEST_CASE("from behind a wall the arm sees less") {
  Scene scene = two_balls();
  const Samples samples = fruit_samples(scene);
  // As far to the left as to the right, so that only the wall makes a difference.
  const Workcell cell = cell_of({0.0, 0.3, 0.0});
  const BaseSearchParameters parameters = quick(0.6, 0.6);
  const std::vector<BasePlace> open = base_search(TracedScene(scene), samples, cell, parameters);
  scene.objects.push_back(wall());
  const std::vector<BasePlace> walled = base_search(TracedScene(scene), samples, cell, parameters);
  CHECK(at(open, 0.6, 0.3).observable > 0.3);
  CHECK(at(walled, 0.6, 0.3).observable < 0.8 * at(open, 0.6, 0.3).observable);
  CHECK(at(walled, 0.6, 0.3).observable < at(walled, -0.6, 0.3).observable);
  // A wall never makes anything visible.
  for (const BasePlace& place : open) CHECK(at(walled, place.base.x(), place.base.y()).observable <= place.observable);
}

TEST_CASE("what the robot stands on moves with it, and it does not stand inside anything else") {
  Workcell cell = cell_of({0.0, 0.0, 0.0});
  cell.keep_out = {{"platform", Box{{0.0, -0.1, -0.06}, {0.7, 0.7, 0.1}}},
                   {"plate", Cylinder{{0.0, 0.0, 0.0}, 0.1, 0.02}},
                   {"cupboard", Box{{0.3, 0.0, 0.0}, {0.4, 0.1, 1.0}}},
                   {"shelf", Box{{0.0, 0.3, 0.005}, {0.4, 0.1, 0.01}}}};  // its lower face at the base's height
  CHECK(stands_on(cell, cell.keep_out[0]));
  CHECK(stands_on(cell, cell.keep_out[1]));
  CHECK_FALSE(stands_on(cell, cell.keep_out[2]));
  const Workcell moved = with_base_moved(cell, {0.1, 0.2, 0.0});
  CHECK(moved.world_T_base.translation() == Eigen::Vector3d(0.1, 0.2, 0.0));
  CHECK(std::get<Box>(moved.keep_out[0].shape).center.isApprox(Eigen::Vector3d(0.1, 0.1, -0.06)));
  CHECK(std::get<Cylinder>(moved.keep_out[1].shape).center.isApprox(Eigen::Vector3d(0.1, 0.2, 0.0)));
  CHECK(std::get<Box>(moved.keep_out[2].shape).center == Eigen::Vector3d(0.3, 0.0, 0.0));

  // A robot that hangs "stands" on the ceiling.
  Workcell hanging = cell;
  hanging.world_T_base = pose_from_xyz_rpy({0.0, 0.0, 1.0}, {kPi, 0.0, 0.0});
  CHECK(stands_on(hanging, {"ceiling", Box{{0.0, 0.0, 1.06}, {1.0, 1.0, 0.1}}}));
  CHECK_FALSE(stands_on(hanging, {"shelf", Box{{0.0, 0.0, 0.94}, {1.0, 1.0, 0.1}}}));

  const Scene scene = two_balls();
  const TracedScene traced(scene);
  const Samples samples = fruit_samples(scene);
  BaseSearchParameters parameters = quick(0.3, 0.3);
  parameters.limit.candidates = 60;
  const std::vector<BasePlace> places = base_search(traced, samples, cell, parameters);
  CHECK(at(places, 0.3, 0.0).blocked);
  CHECK(at(places, 0.3, 0.0).blocked_by == "cupboard");
  CHECK(at(places, 0.3, 0.0).observable == 0.0);
  CHECK(places.back().blocked);
  CHECK(std::count_if(places.begin(), places.end(), [](const BasePlace& p) { return p.blocked; }) == 1);
  CHECK_FALSE(at(places, 0.0, 0.3).blocked);  // a point on a face is not inside
  CHECK_FALSE(present(places).blocked);
  CHECK(present(places).observable > 0.0);
}

TEST_CASE("a base search far from everything, without fruit, or with unusable parameters") {
  const Scene scene = two_balls();
  const TracedScene traced(scene);
  const Samples samples = fruit_samples(scene);
  const BaseSearchParameters parameters = quick(0.1, 0.1);
  for (const BasePlace& place : base_search(traced, samples, cell_of({3.0, 0.0, 0.0}), parameters)) {
    CHECK(place.observable == 0.0);
    CHECK(place.least == 0.0);
    CHECK(place.poses == 0);
    CHECK_FALSE(place.views);
  }
  // Only one side of the grid is near enough.
  const auto places = base_search(traced, samples, cell_of({1.2, 0.5, 0.0}), quick(0.5, 0.5));
  CHECK(places.front().base.x() == Approx(0.7));
  CHECK(places.front().observable > 0.0);
  CHECK(base_search(traced, Samples{}, cell_of({0.0, 0.0, 0.0}), parameters).size() == 9);
  CHECK(fruit_shares(Samples{}, {}).empty());
  CHECK(fruit_shares(samples, {}).size() == 2);
  CHECK_THROWS_AS(fruit_shares(samples, Flags(3, 1)), InputError);
  for (const auto& bad : {quick(-0.1, 0.1), quick(0.1, 0.0), quick(1.0, 0.001), quick(0.1, std::nan(""))})
    CHECK_THROWS_AS(base_search(traced, samples, cell_of({0.0, 0.0, 0.0}), bad), ParameterError);
  BaseSearchParameters none = parameters;
  none.share = 0.0;
  CHECK_THROWS_AS(none.check(), ParameterError);
}
