// SPDX-License-Identifier: BSD-3-Clause
// Collisions of the arm: postures and spaces worked out by hand, and the sensor at a space's border.
#include <agrisee/arm/collision.hpp>
#include <agrisee/core/random.hpp>

#include <limits>

#include "arm/postures.hpp"
#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::arm;
using Eigen::Vector3d;
using test::joints;
using test::kStart;

namespace {

const Joints kStretched = Joints::Zero();                   // along x, 0.15 m up
const Joints kUp = joints(0, -kPi / 2, 0, -kPi / 2, 0, 0);  // a pole over the base

KeepOut box(const Vector3d& center, const Vector3d& size) { return {"box", Box{center, size}}; }

std::string contact(const Joints& q, const Mount& mount) {
  const auto c = find_collision(q, mount);
  return c ? std::string(to_string(c->part)) + "/" + std::string(c->with) : "free";
}

Mount mount_with(const KeepOut& space) {
  Mount mount;
  mount.keep_out = {space};
  return mount;
}

}  // namespace

TEST_CASE("collision: each part meets a small box put where it is") {
  Mount mount;
  CHECK(contact(kStretched, mount) == "free");
  CHECK(contact(kUp, mount) == "free");
  CHECK(contact(kStart, mount) == "free");
  const Vector3d tiny = Vector3d::Constant(0.002);
  // Stretched along x: shoulder over the base; the upper arm 0.12 m beside, the forearm 0.0275 m beside the plane.
  CHECK(contact(kStretched, mount_with(box({0.0, 0.0, 0.12}, tiny))) == "shoulder/box");
  CHECK(contact(kStretched, mount_with(box({0.15, 0.12, 0.1519}, tiny))) == "upper_arm/box");
  CHECK(contact(kStretched, mount_with(box({0.24365 + 0.10, 0.0275, 0.1519}, tiny))) == "forearm/box");
  CHECK(contact(kStretched, mount_with(box({0.4569, 0.11235, 0.1519}, tiny))) == "wrist_1/box");
  CHECK(contact(kStretched, mount_with(box({0.4569, 0.11235, 0.06655}, tiny))) == "wrist_2/box");
  CHECK(contact(kStretched, mount_with(box({0.4569, 0.11235 + 0.065, 0.06655}, tiny))) == "wrist_3/box");
  CHECK(contact(kStretched, mount_with(box({0.4569, 0.19425 + 0.015, 0.06655}, tiny))) == "sensor/box");
  CHECK(contact(kStretched, mount_with(box({0.4569, 0.19425 + 0.035, 0.06655}, tiny))) == "free");
  // Over the upper arm: its tube is 93 mm thick near the shoulder, 78 mm farther out.
  CHECK(contact(kStretched, mount_with(box({0.06, 0.12, 0.1519 + 0.045}, tiny))) == "upper_arm/box");
  CHECK(contact(kStretched, mount_with(box({0.15, 0.12, 0.1519 + 0.045}, tiny))) == "free");
  // The base is not tested.
  CHECK(contact(kStretched, mount_with(box({0.0, 0.0, 0.03}, Vector3d::Constant(0.05)))) == "free");
}

TEST_CASE("collision: spaces are in world, the arm where its base stands") {
  Mount mount = mount_with(box({0.15, 0.12, 0.1519}, Vector3d::Constant(0.02)));
  CHECK(contact(kStretched, mount) == "upper_arm/box");
  mount.world_T_base = pose_from_xyz_rpy({0, 0, 0}, {0, 0, kPi / 2});
  CHECK(contact(kStretched, mount) == "free");
  mount.keep_out = {box({-0.12, 0.15, 0.1519}, Vector3d::Constant(0.02))};
  CHECK(contact(kStretched, mount) == "upper_arm/box");
  mount.world_T_base.translation() = Vector3d(1, 2, 3);
  CHECK(contact(kStretched, mount) == "free");
  mount.keep_out = {{"post", Cylinder{{1 - 0.12, 2 + 0.15, 3.0}, 0.01, 2.0}}};
  CHECK(contact(kStretched, mount) == "upper_arm/post");
}

TEST_CASE("collision: the sensor may stand exactly at the border of a space") {
  // A sensor that looks along y at an upright cylinder of radius 0.35.
  Mount mount = mount_with({"cluster", Cylinder{{0.0, 0.6, 0.3}, 0.35, 0.9}});
  const auto at = [](double y) { return look_along({0.0, y, 0.3}, {0, 1, 0}); };
  CHECK_FALSE(sensor_collision(at(0.25), mount));
  CHECK_FALSE(sensor_collision(at(0.2499), mount));
  REQUIRE(sensor_collision(at(0.2501), mount));
  CHECK(*sensor_collision(at(0.2501), mount) == "cluster");
  // Turned sideways, its 61 mm of diameter count; turned away, its 26 mm of depth.
  CHECK_FALSE(sensor_collision(look_along({0.0, 0.25 - 0.0306, 0.3}, {0, 0, 1}), mount));
  CHECK(sensor_collision(look_along({0.0, 0.25 - 0.0304, 0.3}, {0, 0, 1}), mount));
  CHECK_FALSE(sensor_collision(look_along({0.0, 0.25 - 0.0261, 0.3}, {0, -1, 0}), mount));
  CHECK(sensor_collision(look_along({0.0, 0.25 - 0.0259, 0.3}, {0, -1, 0}), mount));
  // And a box: looking at a corner, the optical center may touch it.
  mount.keep_out = {box({0.5, 0.5, 0.5}, {1, 1, 1})};
  const Vector3d inwards(1, 1, 1);
  CHECK_FALSE(sensor_collision(look_along(Vector3d::Zero(), inwards), mount));
  CHECK(sensor_collision(look_along(Vector3d::Constant(0.001), inwards), mount));
}

TEST_CASE("collision: the arm meets itself") {
  const Mount mount;
  // The forearm folded back on the upper arm drives the wrist into the shoulder.
  CHECK(collides(joints(0, -kPi / 2, kPi, 0, 0, 0), mount));
  // The wrist folded back along the forearm, the tool turned into it; turned away from it the arm is free.
  CHECK(contact(joints(0, -kPi / 2, 0, kPi / 2, kPi, 0), mount) == "forearm/wrist_3");
  CHECK(contact(joints(0, -kPi / 2, 0, kPi / 2, 0, 0), mount) == "free");
  // An everyday posture, the tool pointing down.
  CHECK(contact(joints(0, -kPi / 4, kPi / 2, -kPi / 4 - kPi / 2, -kPi / 2, 0), mount) == "free");
  // Neighbors are never reported, whatever their angle.
  Rng rng(1);
  const std::string neighbors[] = {"shoulder/upper_arm", "upper_arm/forearm", "forearm/wrist_1", "wrist_1/wrist_2",
                                   "wrist_2/wrist_3",    "wrist_3/sensor",    "wrist_2/sensor",  "shoulder/base"};
  int collisions = 0;
  for (int i = 0; i < 3000; ++i) {
    Joints q;
    for (int j = 0; j < 6; ++j) q[j] = rng.uniform(-kPi, kPi);
    const std::string c = contact(q, mount);
    collisions += c != "free";
    for (const std::string& n : neighbors) REQUIRE(c != n);
  }
  CHECK(collisions > 300);
  CHECK(collisions < 2500);
}

TEST_CASE("collision: a camera beside the flange may meet the wrist before it") {
  Mount mount;
  mount.tool0_T_optical.translation() = Vector3d(0, -0.07, -0.06);
  int with_wrist_2 = 0;
  for (int i = 0; i < 64; ++i)
    with_wrist_2 += contact(joints(0.5, -1.5, 1.2, -0.6, -1.6, 0.1 * i), mount) == "wrist_2/sensor";
  CHECK(with_wrist_2 > 0);
  CHECK(with_wrist_2 < 32);
  mount.tool0_T_optical.translation() = Vector3d(0, -0.08, 0.03);
  for (int i = 0; i < 64; ++i) CHECK(contact(joints(0.5, -1.5, 1.2, -0.6, 1.0, 0.1 * i), mount) == "free");
}

TEST_CASE("collision: the pieces stand where the links do") {
  // Each joint's axis passes through its own housing; the elbow's upper-arm housing ends where the forearm's begins.
  const auto pieces = pieces_in_world(kStretched, Mount{});
  REQUIRE(pieces.back().part == Part::sensor);
  CHECK((pieces.back().cylinder.center - Vector3d(0.4569, 0.19425 + 0.03 - 0.013, 0.06655)).norm() < 1e-12);
  CHECK((pieces.back().cylinder.axis - Vector3d(0, 1, 0)).norm() < 1e-12);
  for (const Piece& p : pieces) {
    CHECK(p.cylinder.axis.norm() == Approx(1.0));
    // The capsule encloses the cylinder: rim points of both ends.
    const Vector3d across = any_orthogonal(p.cylinder.axis);
    for (const double end : {-0.5, 0.5}) {
      const Vector3d rim = p.cylinder.center + end * p.cylinder.height * p.cylinder.axis + p.cylinder.radius * across;
      CHECK(segment_distance(rim, rim, p.capsule.a, p.capsule.b) <= p.capsule.radius + 1e-12);
    }
  }
  // Overall thickness of the joints, as on the data sheet's drawing: about 90 mm at shoulder and elbow, 65 at the
  // wrist.
  for (const Piece& p : ur3_pieces()) {
    CHECK(p.cylinder.radius > 0.03);
    CHECK(p.cylinder.radius < 0.07);
  }
}

TEST_CASE("collision: input that is no posture and no mount is refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Mount mount;
  CHECK_THROWS_AS(collides(joints(0, nan, 0, 0, 0, 0), mount), InputError);
  mount.check();
  mount.keep_out = {box({0, 0, 0}, {1, -1, 1})};
  CHECK_THROWS_AS(mount.check(), ParameterError);
  mount = {};
  mount.world_T_base.translation().z() = nan;
  CHECK_THROWS_AS(mount.check(), ParameterError);
  CHECK(collides(kUp, mount_with({"nowhere", Cylinder{{nan, 9, 9}, 0.1, 0.1}})));  // not silently free
  mount = {};
  mount.sensor.depth = 0.0;
  CHECK_THROWS_AS(mount.check(), ParameterError);
}

TEST_CASE("longer arms have longer and wider solids, and are free in common postures") {
  for (const UrModel& model : ur_models()) {
    CAPTURE(std::string(model.name));
    Mount mount;
    mount.model = model;
    CHECK_FALSE(collides((Joints() << 0.0, -1.57, 1.57, -1.57, -1.57, 0.0).finished(), mount));
    CHECK_FALSE(collides((Joints() << 0.0, -0.8, 1.2, -0.4, -1.57, 0.0).finished(), mount));
    // Folded onto itself: the wrist in the upper arm.
    CHECK(collides((Joints() << 0.0, -1.57, 3.1, 0.0, 0.0, 0.0).finished(), mount));
    // The solids reach from joint to joint: a post at the elbow of the stretched arm is hit, one beyond the arm is not.
    const double elbow = -model.a2, end = -model.a2 - model.a3 + 0.4;
    mount.keep_out = {{"post", Box{{elbow, 0.0, model.d1}, {0.01, 1.0, 0.01}}}};
    const auto hit = find_collision(Joints::Zero(), mount);
    REQUIRE(hit);
    CHECK((hit->part == Part::upper_arm || hit->part == Part::forearm));
    mount.keep_out = {{"post", Box{{end, 0.0, model.d1}, {0.01, 1.0, 0.01}}}};
    CHECK_FALSE(collides(Joints::Zero(), mount));
    for (const Piece& piece : model.pieces) {
      CHECK(piece.cylinder.height > 0.01);
      CHECK(piece.cylinder.radius >= 0.0329);
    }
  }
}
