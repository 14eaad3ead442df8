// SPDX-License-Identifier: BSD-3-Clause
// What a UR3 that stands at the origin can see of a truss half a metre before it.
#include <agrisee/arm/reachability.hpp>
#include <agrisee/core/random.hpp>

#include <limits>

#include "arm/postures.hpp"
#include "catch.hpp"
#include "support/says.hpp"

using namespace agrisee;
using namespace agrisee::arm;
using Eigen::Vector3d;
using test::kStart;

namespace {

const Vector3d kTruss(0.015, 0.545, 0.21);

/// The cell of the scene format's example.
Mount cell() {
  Mount mount;
  mount.keep_out = {{"platform", Box{{0, -0.1, -0.06}, {0.7, 0.7, 0.1}}},
                    {"plant", Box{{0, 0.85, 0.3}, {1.2, 0.5, 1.6}}},
                    {"cluster", Cylinder{kTruss, 0.35, 0.9}}};
  return mount;
}

/// From the sensor to the truss; azimuth 0 is frontal, positive from the right; positive elevations look down.
Vector3d sight(double azimuth_deg, double elevation_deg) {
  const double az = deg(azimuth_deg), el = deg(elevation_deg);
  return {-std::sin(az) * std::cos(el), std::cos(az) * std::cos(el), -std::sin(el)};
}

void check_reached(const Mount& mount, const Joints& present, const Reached& r) {
  const Pose stands = mount.world_T_base * forward(r.joints) * mount.tool0_T_optical;
  REQUIRE((stands.matrix() - r.world_T_optical.matrix()).cwiseAbs().maxCoeff() < 1e-9);
  REQUIRE(mount.model.limits.contain(r.joints));
  REQUIRE_FALSE(collides(r.joints, mount));
  REQUIRE(r.move_time == move_time(present, r.joints, mount.model.limits));
}

}  // namespace

TEST_CASE("reach: the frontal view is out of reach, views beside it are not") {
  const Mount mount = cell();
  CHECK_FALSE(collides(kStart, mount));
  ReachParameters at_distance = ReachParameters::paper();
  CHECK_FALSE(reach(mount, kStart, kTruss, sight(0, 0), at_distance));
  CHECK_FALSE(reach(mount, kStart, kTruss, sight(0, 0)));  // nor at any other distance
  CHECK(reach(mount, kStart, kTruss, sight(20, 0), at_distance));
  CHECK(reach(mount, kStart, kTruss, sight(-20, 0), at_distance));
  int reachable = 0;
  for (int az = -90; az <= 90; az += 15)
    for (int el = -30; el <= 45; el += 15)
      if (const auto r = reach(mount, kStart, kTruss, sight(az, el))) {
        ++reachable;
        check_reached(mount, kStart, *r);
        CHECK((r->world_T_optical.linear().col(2) - sight(az, el)).norm() < 1e-12);
        CHECK((r->world_T_optical * Vector3d(0, 0, r->distance) - kTruss).norm() < 1e-12);
        CHECK(std::abs(az) <= 60);
      }
  CHECK(reachable > 15);
}

TEST_CASE("reach: the first distance that serves, and there the shortest move") {
  Mount mount = cell();
  ReachParameters parameters;
  parameters.rolls = GENERATE(1, 3, 24);
  Joints present = kStart;
  present[5] = GENERATE(0.0, 2.5, -6.0);
  mount.model.limits.max[5] = GENERATE(kTwoPi, 1.0);
  mount.model.limits.min[5] = -mount.model.limits.max[5];
  INFO(parameters.rolls << " rolls from " << present[5] << ", up to " << mount.model.limits.max[5]);
  for (const double az : {-40.0, -30.0, -20.0, 20.0, 40.0}) {
    const Vector3d d = sight(az, 10);
    const auto found = reach(mount, present, kTruss, d, parameters);
    // By hand: every distance, every roll, every solution.
    std::optional<double> distance;
    double best = std::numeric_limits<double>::infinity();
    for (const double r : distances_to_try(parameters)) {
      for (int i = 0; i < parameters.rolls; ++i) {
        const Pose view = look_along(kTruss - r * d, d, kTwoPi * i / parameters.rolls);
        for (const Joints& q : inverse(view * mount.tool0_T_optical.inverse())) {
          const auto near = nearest(q, present, mount.model.limits);
          if (near && !collides(*near, mount)) best = std::min(best, move_time(present, *near));
        }
      }
      if (std::isfinite(best)) {
        distance = r;
        break;
      }
    }
    REQUIRE(found.has_value() == distance.has_value());
    if (!found) continue;
    CHECK(found->distance == *distance);
    CHECK(found->move_time == Approx(best).margin(1e-9));
  }
}

TEST_CASE("reach: the same answer every time, and from where the arm already stands no move at all") {
  const Mount mount = cell();
  const auto a = reach(mount, kStart, kTruss, sight(30, 10));
  const auto b = reach(mount, kStart, kTruss, sight(30, 10));
  REQUIRE(a);
  CHECK(a->joints == b->joints);
  CHECK(a->world_T_optical.matrix() == b->world_T_optical.matrix());
  const auto again = reach(mount, a->joints, kTruss, sight(30, 10));
  REQUIRE(again);
  CHECK(again->move_time < 1e-9);
  const auto pose = reach(mount, a->joints, a->world_T_optical);
  REQUIRE(pose);
  CHECK(pose->move_time < 1e-9);
  check_reached(mount, a->joints, *pose);
}

TEST_CASE("reach: joints keep to the turn they are in") {
  const Mount mount = cell();
  const auto a = reach(mount, kStart, kTruss, sight(30, 10)).value();
  Joints present = a.joints;
  present[5] += present[5] > 0 ? -kTwoPi : kTwoPi;  // the same posture a turn of the wrist away
  const auto b = reach(mount, present, a.world_T_optical);
  REQUIRE(b);
  CHECK(b->joints[5] == Approx(present[5]));
  CHECK(b->move_time < 1e-9);
}

TEST_CASE("reach: mounts that are turned, moved or hold the sensor aside") {
  Mount mount = cell();
  mount.keep_out.pop_back();
  Rng rng(1);
  int reached = 0;
  for (int i = 0; i < 40; ++i) {
    mount.world_T_base = pose_from_xyz_rpy({rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(0.0, 0.1)},
                                           {0, 0, rng.uniform(-kPi, kPi)});
    mount.tool0_T_optical = pose_from_xyz_rpy({rng.uniform(-0.06, 0.06), rng.uniform(-0.06, 0.06), 0.05},
                                              {rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-kPi, kPi)});
    const Vector3d d = sight(rng.uniform(-60, 60), rng.uniform(-20, 40));
    const auto r = reach(mount, kStart, kTruss, d);
    if (!r) continue;
    ++reached;
    check_reached(mount, kStart, *r);
  }
  CHECK(reached > 10);
}

TEST_CASE("reach: distances are tried outward from the preferred one") {
  ReachParameters p;
  p.distance = 0.4;
  p.distance_min = 0.35;
  p.distance_max = 0.48;
  p.distance_step = 0.03;
  const std::vector<double> expected{0.4, 0.43, 0.37, 0.46, 0.35, 0.48};
  const auto tried = distances_to_try(p);
  REQUIRE(tried.size() == expected.size());
  for (std::size_t i = 0; i < tried.size(); ++i) CHECK(tried[i] == Approx(expected[i]));
  CHECK(distances_to_try(ReachParameters::paper()) == std::vector<double>{0.38});
}

TEST_CASE("reach: nothing out there, and bad input by name") {
  const Mount mount = cell();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(reach(mount, kStart, {5, 5, 5}, sight(0, 0)));
  Pose far = Pose::Identity();
  far.translation().x() = 3.0;
  CHECK_FALSE(reach(mount, kStart, far));
  CHECK_THROWS_AS(reach(mount, kStart, {nan, 0, 0}, sight(0, 0)), InputError);
  CHECK_THROWS_AS(reach(mount, kStart, kTruss, Vector3d::Zero()), InputError);
  CHECK_THROWS_AS(reach(mount, kStart, kTruss, {nan, 1, 0}), InputError);
  CHECK_THROWS_AS(reach(mount, Joints::Constant(nan), kTruss, sight(0, 0)), InputError);
  far.translation().x() = nan;
  CHECK_THROWS_AS(reach(mount, kStart, far), InputError);
  const auto refused = [&](auto&& change) {
    ReachParameters p;
    change(p);
    CHECK_THROWS_AS(reach(mount, kStart, kTruss, sight(20, 0), p), ParameterError);
  };
  refused([](auto& p) { p.rolls = 0; });
  refused([](auto& p) { p.distance_step = 0.0; });
  refused([](auto& p) { p.distance_min = -0.1; });
  refused([](auto& p) { p.distance = 0.9; });
  refused([](auto& p) { p.distance = 0.1; });
  refused([nan](auto& p) { p.distance = nan; });
  refused([](auto& p) { p.distance_max = std::numeric_limits<double>::infinity(); });
}

TEST_CASE("reach: arms whose lengths the inverse kinematics cannot have are refused by name") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const UrModel& model : ur_models()) model.check();
  const auto refused = [&](double UrModel::*length, double value, const std::string& name) {
    Mount mount;
    mount.model.*length = value;
    CHECK_THROWS_WITH(mount.check(), test::says("UrModel::" + name + " must be "));
    CHECK_THROWS_AS(reach(mount, kStart, kTruss, sight(20, 0)), ParameterError);
  };
  for (const double value : {nan, inf, -inf}) {
    refused(&UrModel::d1, value, "d1");
    refused(&UrModel::a2, value, "a2");
    refused(&UrModel::a3, value, "a3");
    refused(&UrModel::d4, value, "d4");
    refused(&UrModel::d5, value, "d5");
    refused(&UrModel::d6, value, "d6");
  }
  for (const double value : {0.0, 0.24365}) {
    refused(&UrModel::a2, value, "a2");
    refused(&UrModel::a3, value, "a3");
    refused(&UrModel::d4, -value, "d4");
    refused(&UrModel::d5, -value, "d5");
  }
  Mount mount;
  mount.model.d1 = mount.model.d6 = 0.0;
  mount.check();
  mount.model.limits.velocity[0] = 0.0;
  CHECK_THROWS_WITH(mount.check(), test::says("limits.velocity"));
}
