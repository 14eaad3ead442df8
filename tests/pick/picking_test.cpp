// SPDX-License-Identifier: BSD-3-Clause
// Approaches, pre-grasp poses and the order of picking, in cells small enough to judge by hand.
#include <agrisee/arm/collision.hpp>
#include <agrisee/arm/ur.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/pick/arm_approach.hpp>
#include <agrisee/pick/picking.hpp>
#include <agrisee/plan/directions.hpp>

#include <algorithm>
#include <limits>
#include <numeric>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::pick;
using Eigen::Vector3d;

namespace {

const Joints kStart = (Joints() << 0.0, -1.57, 1.57, -1.57, -1.57, 0.0).finished();
constexpr double kRadius = 0.035;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Fruit fruit(int id, const Vector3d& center, const Vector3d& radii = Vector3d::Constant(kRadius)) {
  Fruit f;
  f.id = id;
  f.centroid = center;
  f.sigma = Vector3d::Constant(0.02);
  Body body;
  body.center = center;
  body.radii = radii;
  f.body = body;
  return f;
}

/// The UR3 at the origin, holding its tool on its axis.
arm::Mount ur3() { return {}; }

PickingScene scene(std::vector<KeepOut> keep_out = {}) {
  PickingScene s;
  s.keep_out = std::move(keep_out);
  s.joints = kStart;
  return s;
}

std::vector<Picking> plan_with_ur3(const std::vector<Fruit>& fruits, const PickingScene& s,
                                   const PickingParameters& p = {}, const arm::Mount& mount = ur3()) {
  return plan_picking(fruits, s, approach_of(mount, mount.tool0_T_optical, p), p);
}

/// The spaces that count for a fruit.
std::vector<KeepOut> counting(const std::vector<KeepOut>& all, const Vector3d& center) {
  std::vector<KeepOut> out;
  for (const KeepOut& k : all)
    if (distance(k, center) > 0.0) out.push_back(k);
  return out;
}

/// A pick that can be done is what it says: pose, joints, limits and collisions.
void check_pick(const Picking& pick, const Fruit& f, const PickingScene& s, const PickingParameters& p = {},
                arm::Mount mount = ur3()) {
  REQUIRE(pick.reachable);
  REQUIRE(pick.joints);
  CHECK(pick.reason == PickingReason::reachable);
  CHECK(pick.direction.norm() == Approx(1.0));
  const Pose& pose = pick.world_T_pre_grasp;
  CHECK(is_rigid(pose));
  CHECK((pose.linear().col(2) - pick.direction).norm() < 1e-9);
  const double ahead = (f.body->center - pose.translation()).dot(pick.direction);
  CHECK((pose.translation() + ahead * pick.direction - f.body->center).norm() < 1e-9);
  const Vector3d surface = f.body->center - (ahead - p.stand_off) * pick.direction;
  CHECK((f.body->axes.transpose() * (surface - f.body->center)).cwiseQuotient(f.body->radii).norm() == Approx(1.0));
  CHECK(pick.direction.dot(-f.orientation.col(2)) <= std::cos(p.pedicel_angle) + 1e-9);
  const Pose tool = mount.tool0_T_optical;
  CHECK((mount.world_T_base * arm::forward(*pick.joints) * tool).isApprox(pose, 1e-9));
  CHECK(mount.model.limits.contain(*pick.joints));
  mount.keep_out = counting(s.keep_out, f.body->center);
  // The whole way, in finer steps than it was planned in.
  Joints q = *pick.joints;
  constexpr int kSteps = 40;
  for (int i = 0; i <= kSteps; ++i) {
    Pose here = pose;
    here.translation() += i * (p.stand_off - p.contact) / kSteps * pick.direction;
    std::optional<Joints> next;
    for (const Joints& solution :
         arm::inverse(mount.world_T_base.inverse() * here * tool.inverse(), mount.model.limits, q[5])) {
      const auto near = arm::nearest(solution, q, mount.model.limits);
      if (near && (!next || (*near - q).norm() < (*next - q).norm())) next = near;
    }
    REQUIRE(next);
    CHECK((*next - q).cwiseAbs().maxCoeff() < 0.3);
    CHECK_FALSE(arm::collides(*next, mount));
    q = *next;
  }
}

/// Walls that leave only the way from the robot's side to what is near (0, y, 0.2).
std::vector<KeepOut> tube() {
  return {{"left", Box{{-0.12, 0.55, 0.2}, {0.10, 0.2, 0.6}}},
          {"right", Box{{0.12, 0.55, 0.2}, {0.10, 0.2, 0.6}}},
          {"top", Box{{0, 0.55, 0.32}, {0.3, 0.2, 0.10}}},
          {"bottom", Box{{0, 0.55, 0.08}, {0.3, 0.2, 0.10}}},
          {"back", Box{{0, 0.75, 0.2}, {0.5, 0.1, 0.5}}}};
}

std::vector<Fruit> bunch(std::uint64_t seed, int n) {
  Rng rng(seed);
  std::vector<Fruit> fruits;
  while (static_cast<int>(fruits.size()) < n) {
    const Vector3d center(rng.uniform(-0.09, 0.09), rng.uniform(0.46, 0.62), rng.uniform(0.1, 0.3));
    bool apart = true;
    for (const Fruit& f : fruits) apart = apart && (f.body->center - center).norm() > 0.071;
    if (!apart) continue;
    Fruit f = fruit(static_cast<int>(fruits.size()) + 1, center,
                    {rng.uniform(0.034, 0.036), rng.uniform(0.031, 0.034), rng.uniform(0.026, 0.031)});
    f.body->axes = Eigen::AngleAxisd(rng.uniform(0, kPi), rng.direction()).toRotationMatrix();
    f.orientation = Eigen::AngleAxisd(rng.uniform(0, 0.6), rng.direction()).toRotationMatrix();
    fruits.push_back(f);
  }
  return fruits;
}

bool same(const Picking& a, const Picking& b) {
  return a.order == b.order && a.reachable == b.reachable && a.reason == b.reason && a.direction == b.direction &&
         a.world_T_pre_grasp.matrix() == b.world_T_pre_grasp.matrix() && a.joints == b.joints && a.after == b.after;
}

}  // namespace

TEST_CASE("picking: a free fruit is approached from the front, across its growth axis") {
  const std::vector<Fruit> fruits{fruit(1, {0.1, 0.5, 0.2})};
  const auto plan = plan_with_ur3(fruits, scene());
  REQUIRE(plan.size() == 1);
  check_pick(plan[0], fruits[0], scene());
  CHECK(plan[0].order == 1);
  CHECK(plan[0].after.empty());
  CHECK(plan[0].direction.y() > 0.8);
  CHECK(std::abs(plan[0].direction.z()) < 0.4);
}

TEST_CASE("picking: sides that were seen and sides without neighbors are preferred") {
  PickingScene s = scene();
  s.seen.resize(1);
  const std::vector<Fruit> one{fruit(1, {0.0, 0.5, 0.2})};
  PickingParameters p;
  p.seen_weight = 5.0;
  for (const double side : {-1.0, 1.0}) {
    s.seen[0].reset();
    for (std::size_t b = 0; b < SeenDirections().size(); ++b)
      s.seen[0].set(b, DirectionBins::directions()[b].dot(Vector3d(side, -1, 0)) > 0.8);
    CHECK(-side * plan_picking(one, s, {}, p)[0].direction.x() > 0.3);
  }
  std::vector<Fruit> two{fruit(1, {0.0, 0.5, 0.2}), fruit(2, {0.075, 0.48, 0.2})};
  p.away_weight = 5.0;
  CHECK(plan_picking(two, scene(), {}, p)[0].direction.x() > 0.1);  // comes from the left, away from its neighbor
  two[1] = fruit(2, {-0.075, 0.48, 0.2});
  CHECK(plan_picking(two, scene(), {}, p)[0].direction.x() < -0.1);

  Cloud cloud;
  Labels labels;
  for (const Vector3d& d : {Vector3d(0.1, -0.9, 0.1), Vector3d(0.9, 0.1, 0.1)}) {
    cloud.points.push_back((two[1].body->center + 0.035 * d).cast<float>());
    labels.push_back(2);
  }
  cloud.points.push_back({0.0f, 0.5f, 0.2f});
  labels.push_back(3);  // of no fruit
  const auto seen = seen_directions(cloud, labels, two);
  CHECK(seen[0].none());
  CHECK(seen[1].count() == 2);
  CHECK(seen[1][static_cast<std::size_t>(DirectionBins::bin({0.1, -0.9, 0.1}))]);
}

TEST_CASE("picking: of two touching fruit one behind the other the front one goes first") {
  const Fruit front = fruit(7, {0.0, 0.5, 0.2}), back = fruit(3, {0.0, 0.57, 0.2});
  PickingParameters p;
  const auto open = plan_picking({back, front}, scene(), {}, p);
  CHECK(open[1].order == 1);
  CHECK(open[0].order == 2);
  CHECK(open[0].after.empty());  // there is a way round
  CHECK(meets(swept_gripper(occupied(back), Vector3d::UnitY(), p), occupied(front)));
  CHECK_FALSE(meets(swept_gripper(occupied(front), Vector3d::UnitY(), p), occupied(back)));
  CHECK_FALSE(meets(swept_gripper(occupied(back), open[0].direction, p), occupied(front)));

  // No way round: the same with walls, and with the arm.
  p.directions = 2000;
  for (const bool arm : {false, true}) {
    const auto walled =
        arm ? plan_with_ur3({back, front}, scene(tube()), p) : plan_picking({back, front}, scene(tube()), {}, p);
    CHECK(walled[1].order == 1);
    CHECK(walled[1].after.empty());
    CHECK(walled[0].order == 2);
    CHECK(walled[0].after == std::vector<int>{7});
    CHECK(walled[0].reason == (arm ? PickingReason::reachable : PickingReason::not_tested));
    CHECK(walled[0].direction.y() > 0.8);
    if (arm) check_pick(walled[0], back, scene(tube()), p);
  }
  // What cannot be picked stays where it is and blocks.
  Fruit odd = front;
  odd.body.reset();
  odd.sigma.setConstant(0.02);
  const auto stuck = plan_picking({back, odd}, scene(tube()), {}, p);
  CHECK(stuck[0].reason == PickingReason::blocked_by_fruit);
  CHECK_FALSE(stuck[0].reachable);
  CHECK(stuck[1].reason == PickingReason::no_body);
}

TEST_CASE("picking: a space in front forces an approach from the side") {
  const std::vector<Fruit> fruits{fruit(1, {0.1, 0.5, 0.2})};
  const std::vector<KeepOut> board{{"board", Box{{0.1, 0.40, 0.2}, {0.08, 0.02, 0.2}}}};
  const Vector3d before = plan_with_ur3(fruits, scene())[0].direction;
  const Capsule straight = swept_gripper(occupied(fruits[0]), before, {});
  CHECK(overlap(straight, board[0]));
  const auto plan = plan_with_ur3(fruits, scene(board));
  check_pick(plan[0], fruits[0], scene(board));
  const Capsule gripper = swept_gripper(occupied(fruits[0]), plan[0].direction, {});
  for (int i = 0; i <= 200; ++i)
    CHECK(distance(board[0], Vector3d(gripper.a + i / 200.0 * (gripper.b - gripper.a))) >= 0.02 - 1e-5);
  CHECK(std::abs(plan[0].direction.x()) > std::abs(before.x()) + 0.1);
}

TEST_CASE("picking: a space that contains the fruit does not count, for gripper and arm, for others it does") {
  const Fruit a = fruit(1, {0.05, 0.5, 0.2});
  const std::vector<KeepOut> around{{"cluster", Cylinder{{0.0, 0.5, 0.2}, 0.15, 0.6}}};
  CHECK(same(plan_with_ur3({a}, scene(around))[0], plan_with_ur3({a}, scene())[0]));
  // Beside the space: round it.
  const Fruit b = fruit(2, {0.0, 0.69, 0.2});
  CHECK(overlap(swept_gripper(occupied(b), Vector3d::UnitY(), {}), around[0]));
  const auto plan = plan_picking({a, b}, scene(around));
  CHECK(plan[0].reason == PickingReason::not_tested);
  CHECK(plan[1].reason == PickingReason::not_tested);
  CHECK_FALSE(overlap(swept_gripper(occupied(b), plan[1].direction, {}), around[0]));
  // Beside it: from the outside. Between it and a wall there is no way left.
  const Fruit near = fruit(1, {0.0, 0.655, 0.2});
  CHECK(plan_picking({near}, scene(around))[0].reason == PickingReason::not_tested);
  const std::vector<KeepOut> both{around[0], {"wall", Box{{0.0, 0.76, 0.2}, {1.0, 0.1, 1.0}}}};
  CHECK(plan_picking({near}, scene(both))[0].reason == PickingReason::blocked_by_keep_out);
}

TEST_CASE("picking: fruit just before a wall are picked from the front, with the gripper out of the wall") {
  for (const double gap : {0.001, 0.01, 0.019, 0.03}) {
    const std::vector<Fruit> fruits{fruit(1, {0.05, 0.5, 0.2})};
    const std::vector<KeepOut> wall{{"wall", Box{{0.0, 0.5 + gap + 0.1, 0.2}, {1.0, 0.1, 1.0}}}};
    const auto plan = plan_with_ur3(fruits, scene(wall));
    REQUIRE(plan[0].reachable);
    CHECK(plan[0].direction.y() > 0.0);
    const Capsule swept = swept_gripper(occupied(fruits[0]), plan[0].direction, {});
    const Capsule gripper = short_of_center(swept);
    CHECK((gripper.b + gripper.radius * plan[0].direction - swept.b).norm() < 1e-12);
    CHECK_FALSE(overlap(gripper, wall[0]));
    CHECK(gripper.b.y() + gripper.radius <= 0.5 + gap + 1e-9);
  }
}

TEST_CASE("picking: a gripper without thickness does not pass through spaces and fruit") {
  const Fruit enclosed = fruit(1, {0.0, 0.5, 0.2});
  std::vector<KeepOut> walls;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      Box wall{enclosed.body->center, Vector3d::Constant(0.3)};
      wall.center[axis] += 0.08 * side;
      wall.size[axis] = 0.02;
      walls.push_back({"wall", wall});
    }
  const OrientedEllipsoid flat{{0.0, 0.0, 0.0}, {0.04, 0.04, 0.01}, Eigen::Matrix3d::Identity()};
  PickingParameters p;
  for (const double radius : {0.0, 1e-7, kTouch, 0.005}) {
    p.gripper_radius = radius;
    CHECK(plan_picking({enclosed}, scene(walls), {}, p)[0].reason == PickingReason::blocked_by_keep_out);
    CHECK(meets(Capsule{{0.03, 0.0, -0.1}, {0.03, 0.0, 0.1}, radius}, flat));
    CHECK_FALSE(meets(Capsule{{0.03, 0.0, 0.02}, {0.03, 0.0, 0.1}, radius}, flat));
  }
}

TEST_CASE("picking: what cannot be picked says why and comes last") {
  const Fruit near = fruit(5, {0.1, 0.5, 0.2}), far = fruit(1, {0.1, 2.0, 0.2});
  Fruit bare = fruit(2, {-0.1, 0.5, 0.2});
  bare.body.reset();
  const auto plan = plan_with_ur3({far, bare, near}, scene());
  check_pick(plan[2], near, scene());
  CHECK(plan[2].order == 1);
  CHECK(plan[1].order == 2);
  CHECK(plan[1].reason == PickingReason::no_body);
  CHECK(plan[1].direction.isZero());
  CHECK(plan[0].order == 3);
  CHECK(plan[0].reason == PickingReason::out_of_reach);
  CHECK(plan[0].direction.norm() == Approx(1.0));
  CHECK((plan[0].world_T_pre_grasp.translation() - far.body->center).norm() == Approx(kRadius + 0.12));
  for (int i : {0, 1}) {
    CHECK_FALSE(plan[static_cast<std::size_t>(i)].reachable);
    CHECK_FALSE(plan[static_cast<std::size_t>(i)].joints);
  }
  // Everything is within a space.
  const std::vector<KeepOut> box{
      {"front", Box{{0.1, 0.5, 0.29}, {1.0, 1.0, 0.1}}}, {"below", Box{{0.1, 0.5, 0.11}, {1.0, 1.0, 0.1}}},
      {"left", Box{{-0.1, 0.5, 0.2}, {0.3, 1.0, 1.0}}},  {"right", Box{{0.3, 0.5, 0.2}, {0.3, 1.0, 1.0}}},
      {"near", Box{{0.1, 0.35, 0.2}, {0.2, 0.2, 0.2}}},  {"back", Box{{0.1, 0.65, 0.2}, {0.2, 0.2, 0.2}}}};
  CHECK(plan_with_ur3({near}, scene(box))[0].reason == PickingReason::blocked_by_keep_out);
  // The arm's own place is forbidden, the gripper's way is free.
  const std::vector<KeepOut> room{{"room", Box{{0.0, 0.0, 0.5}, {2.0, 0.4, 1.2}}}};
  CHECK(plan_with_ur3({near}, scene(room))[0].reason == PickingReason::arm_collision);
  CHECK(plan_with_ur3({}, scene()).empty());
}

TEST_CASE("picking: an approach that the arm can begin but not end is no approach") {
  const ReachApproach reach = approach_of(ur3(), ur3().tool0_T_optical);
  const std::vector<KeepOut> none;
  int begun = 0;
  PickingReason last = PickingReason::reachable;
  for (double y = 0.3; y < 0.7; y += 0.01) {
    const ApproachRequest request{Vector3d::UnitY(), {0.12, y, 0.3}, {0.12, y + 0.12, 0.3}, none, {}};
    const ApproachAnswer answer = reach(request, kStart);
    CHECK(answer.reached.has_value() == (answer.reason == PickingReason::reachable));
    begun += answer.reason == PickingReason::approach_interrupted;
    last = answer.reason;
  }
  CHECK(begun >= 5);
  CHECK(last == PickingReason::out_of_reach);
}

TEST_CASE("picking: tools off the axis, rolled, long, and mounted elsewhere") {
  Rng rng(9);
  int reached = 0;
  for (int i = 0; i < 12; ++i) {
    arm::Mount mount;
    mount.world_T_base = pose_from_xyz_rpy({rng.uniform(-0.1, 0.1), 0, 0}, {0, 0, rng.uniform(-kPi, kPi)});
    mount.tool0_T_optical = pose_from_xyz_rpy({rng.uniform(-0.04, 0.04), rng.uniform(-0.04, 0.04), 0.05},
                                              {rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), rng.uniform(-kPi, kPi)});
    const std::vector<Fruit> fruits{fruit(1, {0.05, 0.5, 0.2})};
    const auto plan = plan_with_ur3(fruits, scene(), {}, mount);
    if (!plan[0].reachable) continue;
    ++reached;
    check_pick(plan[0], fruits[0], scene(), {}, mount);
  }
  CHECK(reached >= 8);
  // The gripper's length behind the tool's origin sweeps too.
  PickingParameters p;
  p.tool_length = 0.15;
  const Capsule gripper = swept_gripper(occupied(fruit(1, {0, 0.5, 0.2})), Vector3d::UnitY(), p);
  CHECK(gripper.a.y() == Approx(0.5 - kRadius - 0.12 - 0.15));
}

TEST_CASE("picking: the swept gripper clears what hangs there, by brute force") {
  const PickingParameters p;
  const std::vector<Vector3d> directions = plan::spread_directions(4000);
  int blocked = 0, later = 0, reachable = 0;
  const std::vector<KeepOut> walls{{"left", Box{{-0.2, 0.55, 0.2}, {0.2, 0.4, 0.8}}},
                                   {"right", Box{{0.2, 0.55, 0.2}, {0.2, 0.4, 0.8}}},
                                   {"top", Box{{0, 0.55, 0.41}, {0.6, 0.4, 0.2}}},
                                   {"bottom", Box{{0, 0.55, -0.01}, {0.6, 0.4, 0.2}}},
                                   {"back", Box{{0, 0.75, 0.2}, {0.6, 0.2, 0.6}}}};
  for (int run = 0; run < 8; ++run) {
    const bool walled = run % 2;  // there fruit have to wait for others; the arm is asked where there are no walls
    const std::vector<Fruit> fruits = bunch(static_cast<std::uint64_t>(run / 2 + 1), walled ? 12 : 8);
    const auto plan = walled ? plan_picking(fruits, scene(walls)) : plan_with_ur3(fruits, scene(), p);
    std::vector<int> orders;
    for (std::size_t i = 0; i < fruits.size(); ++i) {
      orders.push_back(plan[i].order);
      if (plan[i].reason > PickingReason::no_body) continue;
      CHECK(plan[i].reachable == !walled);
      reachable += !walled;
      const Capsule gripper = swept_gripper(occupied(fruits[i]), plan[i].direction, p);
      const Vector3d along = gripper.b - gripper.a;
      for (std::size_t j = 0; j < fruits.size(); ++j) {
        if (j == i) continue;
        const OrientedEllipsoid other = occupied(fruits[j]);
        double least = 1e9;
        for (const Vector3d& d : directions) {
          const Vector3d at = other.center + other.axes * other.radii.cwiseProduct(d) - gripper.a;
          const double t = std::clamp(at.dot(along) / along.squaredNorm(), 0.0, 1.0);
          least = std::min(least, (at - t * along).norm());
        }
        const bool must_go = std::count(plan[i].after.begin(), plan[i].after.end(), fruits[j].id) > 0;
        if (must_go) CHECK(plan[j].order < plan[i].order);
        later += must_go;
        if (!must_go) CHECK(least >= p.gripper_radius - 2.0 * kTouch);
        blocked += meets(swept_gripper(occupied(fruits[i]), Vector3d::UnitY(), p), other);
        // Nor does the arm meet it.
        if (!must_go && !walled) CHECK_FALSE(meets_any(*plan[i].joints, ur3(), {other}));
      }
    }
    std::sort(orders.begin(), orders.end());
    for (std::size_t i = 0; i < orders.size(); ++i) CHECK(orders[i] == static_cast<int>(i) + 1);
  }
  CHECK(reachable >= 16);
  CHECK(blocked > 0);
  CHECK(later > 2);
}

TEST_CASE("picking: the arm meets a body where one of its cylinders holds a point of it") {
  Rng rng(4);
  int hits = 0;
  const auto pieces = arm::pieces_in_world(kStart, ur3());
  for (int i = 0; i < 400; ++i) {
    const OrientedEllipsoid body{{rng.uniform(-0.2, 0.5), rng.uniform(-0.3, 0.3), rng.uniform(0.0, 0.6)},
                                 {0.04, 0.035, 0.03},
                                 Eigen::Matrix3d::Identity()};
    bool inside = false;
    double nearest = 1e9;
    for (int k = 0; k < 300; ++k) {
      const Vector3d p = body.center + body.radii.cwiseProduct(std::cbrt(rng.uniform()) * rng.direction());
      for (const arm::Piece& piece : pieces)
        if (piece.part != arm::Part::base) inside = inside || (nearest_point(piece.cylinder, p) - p).norm() < 1e-12;
    }
    for (const arm::Piece& piece : pieces)
      if (piece.part != arm::Part::base)
        nearest = std::min(nearest, (nearest_point(piece.cylinder, body.center) - body.center).norm());
    if (inside) CHECK(meets_any(kStart, ur3(), {body}));
    if (nearest > 0.0401) CHECK_FALSE(meets_any(kStart, ur3(), {body}));
    hits += inside;
  }
  CHECK(hits > 20);
}

TEST_CASE("picking: the same fruit in another order give the same plan") {
  const std::vector<KeepOut> cell{{"platform", Box{{0, -0.1, -0.06}, {0.7, 0.7, 0.1}}},
                                  {"plant", Box{{0, 0.85, 0.3}, {1.2, 0.5, 1.6}}},
                                  {"cluster", Cylinder{{0.015, 0.545, 0.21}, 0.35, 0.9}}};
  const std::vector<Fruit> fruits = bunch(11, 9);
  const auto plan = plan_with_ur3(fruits, scene(cell));
  Rng rng(5);
  for (int trial = 0; trial < 3; ++trial) {
    std::vector<std::size_t> order(fruits.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[static_cast<std::size_t>(rng.uniform(0.0, static_cast<double>(i)))]);
    std::vector<Fruit> shuffled;
    for (std::size_t i : order) shuffled.push_back(fruits[i]);
    const auto again = plan_with_ur3(shuffled, scene(cell));
    for (std::size_t i = 0; i < order.size(); ++i) CHECK(same(again[i], plan[order[i]]));
  }
}

TEST_CASE("picking: a caller's own arm answers") {
  const std::vector<Fruit> fruits{fruit(1, {0.0, 0.5, 0.2}), fruit(2, {0.1, 0.52, 0.2})};
  int asked = 0;
  const auto plan =
      plan_picking(fruits, scene(), [&](const ApproachRequest& r, const Joints& current) -> ApproachAnswer {
        ++asked;
        CHECK(current == kStart);
        CHECK(r.others.size() == 1);
        CHECK((r.end - r.start).normalized().isApprox(r.direction));
        if (r.direction.x() < 0.5) return {};
        return {ReachableApproach{look_along(r.start, r.direction), std::nullopt}, PickingReason::reachable};
      });
  CHECK(asked > 2);
  for (const Picking& p : plan) {
    CHECK(p.reachable);
    CHECK_FALSE(p.joints);
    CHECK(p.direction.x() >= 0.5);
  }
  for (const Picking& p :
       plan_picking(fruits, scene(), [](const ApproachRequest&, const Joints&) { return ApproachAnswer{}; }))
    CHECK(p.reason == PickingReason::out_of_reach);
}

TEST_CASE("picking: within a depth the arm's shortest moves decide, then the id") {
  // Joints by place: the arm of this test turns one joint by x.
  const ReachApproach arm = [](const ApproachRequest& r, const Joints&) {
    Joints q = Joints::Zero();
    q[0] = std::round(100.0 * r.end.x());
    return ApproachAnswer{ReachableApproach{look_along(r.start, r.direction), q}, PickingReason::reachable};
  };
  PickingScene s;
  s.robot.x() = 0.25;  // the mean of the fruit is straight ahead
  const auto orders = [&](const std::vector<Fruit>& fruits) {
    std::vector<int> out;
    for (const Picking& p : plan_picking(fruits, s, arm)) out.push_back(p.order);
    return out;
  };
  CHECK(orders({fruit(1, {0.4, 0.5, 0.2}), fruit(2, {0.2, 0.51, 0.2}), fruit(3, {0.3, 0.505, 0.2}),
                fruit(4, {0.1, 0.6, 0.2})}) == std::vector<int>{3, 1, 2, 4});
  CHECK(orders({fruit(9, {0.2, 0.5, 0.4}), fruit(2, {0.2, 0.5, 0.0})})[1] == 1);
}

TEST_CASE("picking: fruit that cannot be picked show the approach that came farthest") {
  const ReachApproach arm = [](const ApproachRequest& r, const Joints&) {
    return ApproachAnswer{std::nullopt,
                          r.direction.x() > 0.5 ? PickingReason::approach_interrupted : PickingReason::out_of_reach};
  };
  const auto plan = plan_picking({fruit(1, {0.0, 0.5, 0.2})}, scene(), arm);
  CHECK(plan[0].reason == PickingReason::approach_interrupted);
  CHECK(plan[0].direction.x() > 0.5);
}

TEST_CASE("picking: depth is horizontal, whatever hangs below the robot") {
  const auto plan = plan_picking({fruit(1, {0.0, 0.55, -0.2}), fruit(2, {0.0, 0.5, -0.8})}, scene());
  CHECK(plan[0].order == 2);
  CHECK(plan[1].order == 1);
}

TEST_CASE("picking: one roll is enough, on the axis of the last joint and off it") {
  PickingParameters p;
  p.rolls = 1;
  const std::vector<Fruit> fruits{fruit(1, {0.1, 0.5, 0.2})};
  for (const double off : {0.0, 0.03}) {
    arm::Mount mount = ur3();
    mount.tool0_T_optical = pose_from_xyz_rpy({off, 0, 0.05}, {0, 0, 0});
    check_pick(plan_with_ur3(fruits, scene(), p, mount)[0], fruits[0], scene(), p, mount);
  }
}

TEST_CASE("picking: a tool on the axis takes the roll that turns the last joint least") {
  const PickingParameters p;
  for (const double last : {-2.0, -1.0, 0.4, 1.3, 2.2}) {
    PickingScene s = scene();
    s.joints[5] = last;
    const auto plan = plan_with_ur3({fruit(1, {0.1, 0.5, 0.2})}, s, p);
    REQUIRE(plan[0].joints);
    CHECK(std::abs((*plan[0].joints)[5] - last) <= kPi / p.rolls + 1e-9);
  }
}

TEST_CASE("picking: a roll that the limits of joint 6 stop on its way leaves the others") {
  // Off the axis by so little, all rolls of a tool are tried one by one.
  const Pose on_axis = pose_from_xyz_rpy({0, 0, 0.15}, {0, 0, 0}),
             beside = pose_from_xyz_rpy({2e-9, 0, 0.15}, {0, 0, 0});
  const std::vector<KeepOut> none;
  const std::vector<OrientedEllipsoid> alone;
  Rng rng(3);
  int reached = 0, interrupted = 0;
  for (int i = 0; i < 2000; ++i) {
    arm::Mount mount = ur3();
    Joints q;
    for (int j = 0; j < 6; ++j) q[j] = rng.uniform(-3.0, 3.0);
    if (i % 2) {
      mount.model.limits.min[5] = -rng.uniform(0.2, 3.0);
      mount.model.limits.max[5] = rng.uniform(0.2, 3.0);
      q[5] = 0.0;
    } else {
      q[5] = rng.uniform(4.0, kTwoPi);
    }
    const Vector3d end(rng.uniform(-0.4, 0.4), rng.uniform(0.1, 0.5), rng.uniform(0.0, 0.5)), d = rng.direction();
    const ApproachRequest request{d, end - 0.12 * d, end, none, alone};
    const ApproachAnswer a = approach_of(mount, on_axis)(request, q), b = approach_of(mount, beside)(request, q);
    CAPTURE(i);
    CHECK(a.reason == b.reason);
    REQUIRE(a.reached.has_value() == b.reached.has_value());
    reached += a.reached.has_value();
    interrupted += a.reason == PickingReason::approach_interrupted;
  }
  CHECK(reached > 300);
  CHECK(interrupted > 20);
}

TEST_CASE("picking: a tilted tool whose origin is on the axis is where the joints put it") {
  for (const double x : {-0.1, 0.0, 0.1, 0.2}) {
    arm::Mount mount = ur3();
    mount.tool0_T_optical = pose_from_xyz_rpy({0, 0, 0.05}, {0.3, 0, 0});
    const std::vector<Fruit> fruits{fruit(1, {x, 0.45, 0.2})};
    check_pick(plan_with_ur3(fruits, scene(), {}, mount)[0], fruits[0], scene(), {}, mount);
  }
}

TEST_CASE("picking: the largest change of a joint counts from step to step, not from the start") {
  PickingParameters p;
  p.steps = 100;
  p.max_joint_step = 0.05;
  const std::vector<Fruit> fruits{fruit(1, {0.1, 0.5, 0.2})};
  const auto plan = plan_with_ur3(fruits, scene(), p);
  check_pick(plan[0], fruits[0], scene(), p);
  // All ways from there to the end turn a joint by more.
  Pose end = plan[0].world_T_pre_grasp;
  end.translation() += p.stand_off * plan[0].direction;
  for (const Joints& q : arm::inverse(end * ur3().tool0_T_optical.inverse(), ur3().model.limits, (*plan[0].joints)[5]))
    CHECK((q - *plan[0].joints).cwiseAbs().maxCoeff() > 2.0 * p.max_joint_step);
}

TEST_CASE("picking: an approach of many steps can be cancelled") {
  PickingParameters p;
  p.steps = 1000;
  const std::vector<KeepOut> none;
  const std::vector<OrientedEllipsoid> alone;
  const Vector3d center(0.1, 0.5, 0.2), direction = Vector3d::UnitY();
  const ReachApproach reach = approach_of(ur3(), Pose::Identity(), p);
  const pick::ApproachRequest request{direction, center - p.stand_off * direction, center, none, alone};
  CHECK_NOTHROW(reach(request, kStart));
  const Cancellation stop;
  stop.request();
  const CancellationScope scope(stop);
  CHECK_THROWS_AS(reach(request, kStart), Cancelled);
}

TEST_CASE("picking: the arm gets from each step to the next along the line") {
  // A gripper on the last axis and a camera off it: near the stretched wrist other postures with the same pose are
  // close.
  arm::Mount mount = ur3();
  mount.tool0_T_optical = pose_from_xyz_rpy({0.05, -0.03, 0.04}, {0.2, 0.1, 1.0});
  const Pose tool = pose_from_xyz_rpy({0, 0, 0.15}, {0, 0, 0});
  const PickingParameters p;
  const ReachApproach reach = approach_of(mount, tool, p);
  const std::vector<KeepOut> none;
  const std::vector<OrientedEllipsoid> alone;
  Rng rng(7);
  int reachable = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d center(rng.uniform(-0.3, 0.3), rng.uniform(0.3, 0.6), rng.uniform(0.0, 0.4));
    const Vector3d direction = (Vector3d::UnitY() + rng.direction() * rng.uniform(0.0, 1.2)).normalized();
    const auto found = reach({direction, center - p.stand_off * direction, center, none, alone}, kStart).reached;
    if (!found) continue;
    ++reachable;
    Joints q = *found->joints;
    for (int k = 1; k <= 400; ++k) {
      Pose pose = found->world_T_pre_grasp;
      pose.translation() += k / 400.0 * p.stand_off * direction;
      double least = 10.0;
      Joints next = q;
      for (const Joints& solution : arm::inverse(pose * tool.inverse(), mount.model.limits, q[5]))
        if (const auto near = arm::nearest(solution, q, mount.model.limits))
          if ((*near - q).cwiseAbs().maxCoeff() < least) least = (*near - q).cwiseAbs().maxCoeff(), next = *near;
      if (least > 0.3) break;  // a singular posture, where joints turn at once
      q = next;
      // On the line it comes through the postures that were tested.
      if (k * p.steps % 400 == 0) CHECK(!arm::collides(q, mount));
    }
  }
  CHECK(reachable > 300);
}

TEST_CASE("picking: a workcell's own tool frame is the one that approaches") {
  Workcell workcell;
  workcell.tool0_T_tool = pose_from_xyz_rpy({0.01, 0.02, 0.15}, {0, 0, 0});
  const std::vector<Fruit> fruits{fruit(1, {0.1, 0.45, 0.2})};
  const auto plan = plan_picking(fruits, scene(), approach_of(workcell, {}));
  REQUIRE(plan[0].joints);
  const Pose tool = workcell.world_T_base * arm::forward(*plan[0].joints) * *workcell.tool0_T_tool;
  CHECK(tool.isApprox(plan[0].world_T_pre_grasp, 1e-9));
}

TEST_CASE("picking: bad input by name") {
  const std::vector<Fruit> good{fruit(1, {0.0, 0.5, 0.2})};
  std::vector<Fruit> bad = good;
  bad[0].body->center.x() = kNan;
  CHECK_THROWS_AS(plan_picking(bad, scene()), InputError);
  bad = good;
  bad[0].body->radii.z() = 0.0;
  CHECK_THROWS_AS(plan_picking(bad, scene()), InputError);
  bad = {fruit(3, {0.0, 0.5, 0.2}), fruit(3, {0.2, 0.5, 0.2})};
  CHECK_THROWS_WITH(plan_picking(bad, scene()), "plan_picking: two fruits have the id 3");
  PickingScene s = scene();
  s.joints[2] = kNan;
  CHECK_THROWS_AS(plan_picking(good, s), InputError);
  s = scene();
  s.seen.resize(2);
  CHECK_THROWS_AS(plan_picking(good, s), InputError);
  const auto refused = [&](auto&& change) {
    PickingParameters p;
    change(p);
    CHECK_THROWS_AS(plan_picking(good, scene(), {}, p), ParameterError);
  };
  refused([](auto& p) { p.stand_off = -0.1; });
  refused([](auto& p) { p.contact = 0.2; });
  refused([](auto& p) { p.gripper_radius = kNan; });
  refused([](auto& p) { p.stand_off = 120.0; });  // in millimetres
  refused([](auto& p) { p.contact = -10.0; });
  refused([](auto& p) { p.gripper_radius = 20.0; });
  refused([](auto& p) { p.tool_length = 150.0; });
  refused([](auto& p) { p.directions = 0; });
  refused([](auto& p) { p.directions = 100001; });
  refused([](auto& p) { p.rolls = 0; });
  refused([](auto& p) { p.rolls = 3601; });
  refused([](auto& p) { p.steps = 0; });
  refused([](auto& p) { p.steps = 1001; });
  refused([](auto& p) { p.max_joint_step = 0.0; });
  refused([](auto& p) { p.pedicel_angle = 3.0; });
  refused([](auto& p) { p.front_weight = kNan; });
  Pose skewed = Pose::Identity();
  skewed.linear()(0, 0) = 2.0;
  CHECK_THROWS_AS(approach_of(ur3(), skewed), InputError);
  arm::Mount mount = ur3();
  mount.sensor.radius = 0.0;
  CHECK_THROWS_AS(approach_of(mount, Pose::Identity()), ParameterError);
}
