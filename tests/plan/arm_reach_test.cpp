// SPDX-License-Identifier: BSD-3-Clause
// The reach of a workcell's UR3 is that of arm::reach with the workcell's mount and the sensor's range.
#include <agrisee/arm/reachability.hpp>
#include <agrisee/plan/arm_reach.hpp>

#include <limits>

#include "plan/plan_cases.hpp"
#include "support/says.hpp"

using namespace cases;

namespace {

const Vector3d kTruss(0.015, 0.545, 0.21);

/// A cell whose base, hand-eye transform, spaces and range all matter.
Workcell cell() {
  Workcell w;
  w.world_T_base = pose_from_xyz_rpy({0.02, -0.01, 0.03}, {0.0, 0.0, 0.2});
  w.tool0_T_optical = pose_from_xyz_rpy({0.01, 0.02, 0.05}, {0.0, 0.0, 0.3});
  w.keep_out = {{"plant", Box{{0, 0.85, 0.3}, {1.2, 0.5, 1.6}}}};
  w.sensor.range_min = 0.33;
  w.sensor.range_max = 0.5;
  return w;
}

/// A request from the right (positive azimuths) and above (positive elevations).
ViewRequest request(double azimuth_deg, double elevation_deg, double distance, double nearest, double farthest) {
  const double az = deg(azimuth_deg), el = deg(elevation_deg);
  ViewRequest r;
  r.target = kTruss;
  r.direction = {-std::sin(az) * std::cos(el), std::cos(az) * std::cos(el), -std::sin(el)};
  r.distance = distance;
  r.distance_min = nearest;
  r.distance_max = farthest;
  return r;
}

/// Whether the cell's reach answers a request as arm::reach does for these distances. @return whether there is a view
bool answers(const Workcell& w, const ViewRequest& r, double distance, double nearest, double farthest) {
  arm::ReachParameters p;
  p.distance = distance;
  p.distance_min = nearest;
  p.distance_max = farthest;
  const auto view = reach_of(w)(r, w.start);
  const auto expected = arm::reach(mount_of(w), w.start, r.target, r.direction, p);
  REQUIRE(view.has_value() == expected.has_value());
  if (!view) return false;
  CHECK(view->world_T_optical.matrix() == expected->world_T_optical.matrix());
  CHECK(view->target == r.target);
  CHECK(view->joints == expected->joints);
  CHECK(view->move_time == expected->move_time);
  CHECK(view->move_time > 0.0);
  CHECK(view->gain == 0.0);
  return true;
}

}  // namespace

TEST_CASE("the joints of a view put the camera where the view is, for each arm") {
  const auto put = [](const Workcell& w) {
    const auto view = reach_of(w)(request(40, 20, 0.4, 0.35, 0.5), w.start);
    REQUIRE(view.has_value());
    CHECK(optical_pose(w, *view->joints).isApprox(view->world_T_optical, 1e-9));
    return *view->joints;
  };
  Workcell w = cell();
  const Joints of_ur3 = put(w);
  w.arm = arm::ur_model("ur5e");
  CHECK_FALSE(put(w).isApprox(of_ur3, 0.1));
  Joints q = w.start;
  q[2] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(optical_pose(w, q), InputError);
}

TEST_CASE("arm reach: the mount is the workcell's, its limits and housing are the defaults") {
  const Workcell w = cell();
  const arm::Mount mount = mount_of(w), plain;
  CHECK(mount.world_T_base.matrix() == w.world_T_base.matrix());
  CHECK(mount.tool0_T_optical.matrix() == w.tool0_T_optical.matrix());
  REQUIRE(mount.keep_out.size() == 1);
  CHECK(mount.keep_out[0].name == "plant");
  CHECK(mount.model.limits.min == plain.model.limits.min);
  CHECK(mount.model.limits.max == plain.model.limits.max);
  CHECK(mount.sensor.radius == plain.sensor.radius);
  CHECK(mount.sensor.depth == plain.sensor.depth);
  Workcell large = w;
  large.sensor.housing_radius = 0.065;
  large.sensor.housing_depth = 0.126;
  CHECK(mount_of(large).sensor.radius == 0.065);
  CHECK(mount_of(large).sensor.depth == 0.126);
}

TEST_CASE("arm reach: a view is what the arm's own search finds") {
  const Workcell w = cell();
  int found = 0;
  for (const double azimuth : {-40.0, -20.0, 0.0, 20.0, 40.0})
    for (const double elevation : {-10.0, 10.0, 30.0})
      found += answers(w, request(azimuth, elevation, 0.38, 0.35, 0.45), 0.38, 0.35, 0.45);
  CHECK(found > 5);
  CHECK(found < 15);
}

TEST_CASE("arm reach: distances outside the sensor's range are not offered") {
  const Workcell w = cell();
  CHECK(answers(w, request(30, 10, 0.40, 0.20, 0.90), 0.40, 0.33, 0.50));
  CHECK(answers(w, request(30, 10, 0.25, 0.20, 0.40), 0.33, 0.33, 0.40));  // the nearest that the sensor measures
  CHECK(answers(w, request(30, 10, 0.80, 0.40, 0.90), 0.50, 0.40, 0.50));  // the farthest
  CHECK(answers(w, request(30, 10, 0.33, 0.20, 0.33), 0.33, 0.33, 0.33));  // one distance is enough
}

TEST_CASE("arm reach: a band of distances that the sensor does not measure has no view") {
  const Reach reach = reach_of(cell());
  const Joints start = cell().start;
  CHECK_FALSE(reach(request(30, 10, 0.25, 0.20, 0.32), start));
  CHECK_FALSE(reach(request(30, 10, 0.60, 0.51, 0.70), start));
  CHECK(reach(request(30, 10, 0.40, 0.35, 0.45), start));
}

TEST_CASE("arm reach: another arm is not asked for distances that the sensor does not measure, either") {
  std::vector<ViewRequest> asked;
  const Reach reach = checked(
      [&](const ViewRequest& r, const Joints&) {
        asked.push_back(r);
        return std::nullopt;
      },
      cell().sensor);
  const auto ask = [&](double distance, double nearest, double farthest) {
    asked.clear();
    CHECK_FALSE(reach(request(30, 10, distance, nearest, farthest), cell().start));
    if (asked.empty()) return Vector3d(0, 0, 0);
    CHECK(asked[0].target == kTruss);
    CHECK(asked[0].direction == request(30, 10, distance, nearest, farthest).direction);
    return Vector3d(asked[0].distance, asked[0].distance_min, asked[0].distance_max);
  };
  CHECK(ask(0.40, 0.35, 0.45) == Vector3d(0.40, 0.35, 0.45));
  CHECK(ask(0.40, 0.20, 0.90) == Vector3d(0.40, 0.33, 0.50));
  CHECK(ask(0.25, 0.20, 0.40) == Vector3d(0.33, 0.33, 0.40));
  CHECK(ask(0.80, 0.40, 0.90) == Vector3d(0.50, 0.40, 0.50));
  CHECK(ask(0.25, 0.20, 0.32).isZero());  // not asked at all
  CHECK(ask(0.60, 0.51, 0.70).isZero());
}

TEST_CASE("arm reach: another arm's answers are the views requested, nearly") {
  const ViewRequest asked = request(30, 10, 0.40, 0.35, 0.45);
  const Vector3d beside = any_orthogonal<double>(asked.direction);
  // The answer from some distance and this many degrees beside the direction, moved sideways so that it looks past.
  const auto answered = [&](double distance, double turned, double past = 0.0) {
    const Reach reach = checked(
        [&](const ViewRequest& r, const Joints&) {
          const Vector3d d = std::cos(deg(turned)) * r.direction + std::sin(deg(turned)) * beside;
          ReachableView view;
          view.world_T_optical = look_along(r.target - distance * d + past * any_orthogonal<double>(d), d, 1.0);
          return std::optional(view);
        },
        cell().sensor);
    return reach(asked, cell().start).has_value();
  };
  for (const double distance : {0.331, 0.35, 0.40, 0.45, 0.469}) CHECK(answered(distance, 0.0));
  for (const double turned : {-14.9, -5.0, 5.0, 14.9}) CHECK(answered(0.40, turned));
  CHECK(answered(0.40, 0.0, 0.09));
  const auto says = [](const std::string& text) { return test::says(text); };
  const std::string limits = " from the target, but distance_min and distance_max of the request are 0.35 m and 0.45 m";
  CHECK_THROWS_WITH(answered(3.0, 0.0), says("reach: the view of its answer is 3 m" + limits));
  CHECK_THROWS_WITH(answered(0.02, 0.0), says("reach: the view of its answer is 0.02 m" + limits));
  CHECK_THROWS_WITH(answered(0.329, 0.0), says(limits));
  CHECK_THROWS_WITH(answered(0.471, 0.0), says(limits));
  const std::string direction = "degrees beside the requested direction";
  CHECK_THROWS_WITH(answered(0.40, 40.0), says("sees the target from 40 " + direction));
  for (const double turned : {-15.1, 15.1, 90.0, 180.0}) CHECK_THROWS_WITH(answered(0.40, turned), says(direction));
  CHECK_THROWS_WITH(answered(0.40, 0.0, 0.11), says("does not look at the requested target"));
}

TEST_CASE("arm reach: what cannot be reached has no view, and an invalid mount is refused") {
  Workcell w = cell();
  ViewRequest far = request(30, 10, 0.38, 0.35, 0.45);
  far.target = {5, 5, 5};
  CHECK_FALSE(reach_of(w)(far, w.start));
  w.tool0_T_optical.linear() *= 2.0;
  CHECK_THROWS_AS(reach_of(w), ParameterError);
}

TEST_CASE("arm reach: the arm is the workcell's") {
  Workcell w = cell();
  w.arm = arm::ur_model("ur10e");
  CHECK(mount_of(w).model.name == w.arm.name);
  // The camera would stand some 0.8 m before the base: an arm of 1.3 m reaches that, one of 0.5 m does not.
  ViewRequest far = request(0, 0, 0.4, 0.33, 0.5);
  far.target.y() += 0.7;
  w.keep_out.clear();
  CHECK(reach_of(w)(far, w.start));
  w.arm = arm::ur_model("ur3");
  CHECK_FALSE(reach_of(w)(far, w.start));
}
