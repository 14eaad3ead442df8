// SPDX-License-Identifier: BSD-3-Clause
// What an approach crosses of the measured surroundings, against areas known by hand and brute force, and what the plan
// makes of it.
#include <agrisee/core/random.hpp>
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

constexpr double kBall = 0.035;  // radius of the fruit (m)

Fruit ball(int id, const Vector3d& center, double radius = kBall) {
  Fruit f;
  f.id = id;
  f.centroid = center;
  Body body;
  body.center = center;
  body.radii = Vector3d::Constant(radius);
  f.body = body;
  return f;
}

/// Points spread evenly over a rectangle about `center`, 0.5 mm apart, with the normal u x v if `normals`.
void add_patch(Cloud& cloud, const Vector3d& center, const Vector3d& u, const Vector3d& v, double width, double height,
               bool normals = true) {
  constexpr double kApart = 0.0005;
  for (double a = -0.5 * (width - kApart); a < 0.5 * width; a += kApart)
    for (double b = -0.5 * (height - kApart); b < 0.5 * height; b += kApart) {
      cloud.points.push_back((center + a * u + b * v).cast<float>());
      if (normals) cloud.normals.push_back(u.cross(v).cast<float>());
    }
}

double area_of(const std::vector<SurfacePiece>& pieces) {
  double sum = 0.0;
  for (const SurfacePiece& p : pieces) sum += p.area;
  return sum;
}

/// The pieces inside a capsule, one by one.
double area_inside(const std::vector<SurfacePiece>& pieces, const Capsule& capsule) {
  double sum = 0.0;
  for (const SurfacePiece& p : pieces)
    if (segment_distance(capsule.a, capsule.b, p.center, p.center) <= capsule.radius) sum += p.area;
  return sum;
}

Cloud reordered(const Cloud& cloud, std::uint64_t seed) {
  Indices order(cloud.size());
  std::iota(order.begin(), order.end(), Index{0});
  Rng rng(seed);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(rng.uniform(0.0, static_cast<double>(i)))]);
  return select(cloud, order);
}

PickingScene among(Cloud surroundings) {
  PickingScene s;
  s.surroundings = std::move(surroundings);
  return s;
}

/// A bowl about `center`, 7 cm from it, that is open within `opening` (rad) of the direction `open`.
Cloud bowl(const Vector3d& center, const Vector3d& open, double opening) {
  Cloud cloud;
  for (const Vector3d& d : plan::spread_directions(60000)) {
    if (d.dot(open) > std::cos(opening)) continue;
    cloud.points.push_back((center + 0.07 * d).cast<float>());
    cloud.normals.push_back((-d).cast<float>());
  }
  return cloud;
}

bool same_plan(const std::vector<Picking>& a, const std::vector<Picking>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Picking& p, const Picking& q) {
    return p.order == q.order && p.reason == q.reason && p.direction == q.direction && p.crossed == q.crossed &&
           p.after == q.after;
  });
}

}  // namespace

TEST_CASE("surroundings: the points of no fruit, with their normals") {
  Cloud cloud;
  for (int i = 0; i < 4; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 0.0f, 0.0f);
    cloud.normals.emplace_back(0.0f, 0.0f, i % 2 == 0 ? 1.0f : -1.0f);
  }
  const Cloud rest = surroundings_of(cloud, {0, 2, 1, 0});
  REQUIRE(rest.size() == 2);
  CHECK(rest.points[1] == cloud.points[3]);
  CHECK(rest.normals[1] == cloud.normals[3]);
  CHECK_THROWS_AS(surroundings_of(cloud, {0, 1}), InputError);
  cloud.normals.clear();
  CHECK(surroundings_of(cloud, {0, 2, 1, 0}).normals.empty());
  cloud.normals.emplace_back(0.0f, 0.0f, 1.0f);
  CHECK_THROWS_AS(surroundings_of(cloud, {0, 2, 1, 0}), InputError);
  CHECK_THROWS_AS(surface_pieces(cloud), InputError);
  CHECK(surroundings_of({}, {}).empty());
}

TEST_CASE("surroundings: points of the raw cloud that were dropped count, those that were kept count once") {
  Cloud raw;
  for (int i = 0; i < 5; ++i) {
    raw.points.emplace_back(static_cast<float>(4 - i), 0.0f, 0.0f);
    raw.normals.emplace_back(0.0f, i % 2 == 0 ? 1.0f : -1.0f, 0.0f);
  }
  raw.points[4].x() = std::numeric_limits<float>::quiet_NaN();
  Cloud cloud;
  for (const std::size_t i : {0, 2, 4}) {
    cloud.points.push_back(raw.points[i]);
    cloud.normals.push_back(raw.normals[i]);
  }
  cloud.points[2].x() = 9.0f;
  const Cloud rest = surroundings_of(cloud, {1, 0, 2}, raw);
  REQUIRE(rest.size() == 3);
  CHECK(rest.points[0] == raw.points[2]);
  CHECK(rest.points[1] == raw.points[1]);
  CHECK(rest.points[2] == raw.points[3]);
  CHECK(rest.normals[2] == raw.normals[3]);
  // Where one of the clouds has no normals, those of its points are zero: not known.
  raw.normals.clear();
  const Cloud mixed = surroundings_of(cloud, {1, 0, 2}, raw);
  REQUIRE(mixed.normals.size() == 3);
  CHECK(mixed.normals[0] == cloud.normals[1]);
  CHECK(mixed.normals[1].isZero());
  CHECK(surroundings_of(cloud, {0, 0, 0}, cloud).size() == 3);
}

TEST_CASE("surroundings: patches have their area, however they are turned, and in any order of the points") {
  Rng rng(3);
  for (int turn = 0; turn < 30; ++turn) {
    const Vector3d n = turn == 0 ? Vector3d::UnitZ() : rng.direction(), u = n.unitOrthogonal(), v = n.cross(u);
    Cloud cloud;
    add_patch(cloud, {0.1234, 0.5004, 0.2019}, u, v, 0.2, 0.15);
    INFO("normal " << n.transpose());
    const auto pieces = surface_pieces(cloud);
    CHECK(area_of(pieces) == Approx(0.03).epsilon(0.06));  // cells at the border are counted whole
    for (std::size_t seed : {1, 2}) {
      const auto again = surface_pieces(reordered(cloud, seed));
      REQUIRE(again.size() == pieces.size());
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        REQUIRE(again[i].center == pieces[i].center);
        REQUIRE(again[i].area == pieces[i].area);
      }
    }
  }
  // Without normals: right on average over all directions.
  double sum = 0.0;
  constexpr int kTurns = 60;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Vector3d n = rng.direction(), u = n.unitOrthogonal();
    Cloud cloud;
    add_patch(cloud, rng.direction(), u, n.cross(u), 0.2, 0.15, false);
    sum += area_of(surface_pieces(cloud));
  }
  CHECK(sum / kTurns == Approx(0.03).epsilon(0.08));
}

TEST_CASE("surroundings: pieces of odd points") {
  constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
  CHECK(surface_pieces({}).empty());
  Cloud cloud;
  cloud.points = {
      {0.001f, 0.001f, 0.001f}, {0.001f, 0.001f, 0.001f}, {kNoNumber, 0.0f, 0.0f}, {-0.001f, -0.001f, -0.001f}};
  const auto pieces = surface_pieces(cloud);
  REQUIRE(pieces.size() == 2);
  CHECK((pieces[0].center + Vector3d::Constant(0.001)).norm() < 1e-6);
  CHECK((pieces[1].center - Vector3d::Constant(0.001)).norm() < 1e-6);
  CHECK(pieces[0].area == Approx(kPieceEdge * kPieceEdge / 1.5));
  cloud.normals = {{0, 0, 1}, {kNoNumber, 0, 0}, {0, 0, 1}, {0, 0, 0}};
  const auto known = surface_pieces(cloud);
  CHECK(known[0].area == Approx(kPieceEdge * kPieceEdge / 1.5));
  CHECK(known[1].area == Approx(kPieceEdge * kPieceEdge / 1.25));  // one normal along an axis, one unknown
}

TEST_CASE("surroundings: what is near a body does not count") {
  const OrientedEllipsoid body{{0.0, 0.5, 0.2}, {0.04, 0.03, 0.02}, Eigen::Matrix3d::Identity()};
  std::vector<SurfacePiece> pieces;
  for (int i = 0; i < 100; ++i) pieces.push_back({body.center + Vector3d(0.001 * i, 0, 0), 1.0});
  for (int i = 0; i < 100; ++i) pieces.push_back({body.center - Vector3d(0, 0, 0.001 * i), 1.0});
  const auto far = pieces_beyond(0.0105, body, pieces);
  CHECK(far.size() == 49 + 69);
  for (const SurfacePiece& p : far) CHECK(distance(body, p.center) >= 0.0105);
}

TEST_CASE("surroundings: what each direction crosses is what lies in its swept gripper") {
  Rng rng(8);
  for (const int n : {6, 300, 1000}) {
    const auto directions = plan::spread_directions(n);
    const OrientedEllipsoid body{{0.02, 0.5, 0.2}, {0.04, 0.033, 0.02}, Eigen::Matrix3d::Identity()};
    PickingParameters p;
    p.tool_length = 0.03;
    std::vector<SurfacePiece> pieces;
    for (int i = 0; i < 3000; ++i)
      pieces.push_back({body.center + rng.uniform(0.0, 0.25) * rng.direction(), rng.uniform(0.5, 1.5)});
    pieces.push_back({body.center, 1.0});
    pieces.push_back({body.center + Vector3d(0, 0, 0.1), 1.0});
    pieces.push_back({body.center - Vector3d(0.1, 0, 0), 1.0});
    for (const double radius : {0.001, 0.02, 0.06}) {
      p.gripper_radius = radius;
      const auto crossed = crossed_surface(pieces, body, directions, p);
      REQUIRE(crossed.size() == directions.size());
      for (std::size_t i = 0; i < directions.size(); ++i)
        REQUIRE(crossed[i] == Approx(area_inside(pieces, swept_gripper(body, directions[i], p))).margin(1e-9));
    }
  }
  CHECK(crossed_surface({{Vector3d::Zero(), 1.0}}, occupied(ball(1, {0, 0.5, 0.2})), {}, {}).empty());
}

TEST_CASE("surroundings: a plane across the approach is crossed by the gripper's cross section") {
  PickingParameters p;
  p.clear_weight = 0.0;
  for (const double tilt : {0.0, 0.4, 0.8})
    for (const double radius : {0.02, 0.03}) {
      p.gripper_radius = radius;
      double sum = 0.0;
      constexpr int kPlaces = 10;  // of the cells' borders in the cross section
      for (int i = 0; i < kPlaces; ++i) {
        const Fruit fruit = ball(1, {0.0123 * i, 0.5 + 0.0017 * i, 0.2});
        const Vector3d direction = plan_picking({fruit}, among({}), {}, p)[0].direction;
        const Vector3d side = direction.unitOrthogonal(), level = direction.cross(side);
        const Vector3d normal = std::cos(tilt) * direction + std::sin(tilt) * side;
        Cloud wall;
        add_patch(wall, fruit.body->center - 0.1 * direction, level, normal.cross(level), 0.1, 0.1);
        const Picking pick = plan_picking({fruit}, among(wall), {}, p)[0];
        CHECK(pick.direction == direction);
        sum += pick.crossed;
      }
      INFO("tilt " << tilt << ", radius " << radius);
      CHECK(sum / kPlaces == Approx(kPi * radius * radius / std::cos(tilt)).epsilon(0.05));
    }
}

TEST_CASE("surroundings: an approach that is free goes before one through a wall of points") {
  const Fruit fruit = ball(1, {0.0, 0.5, 0.2});
  Cloud wall;  // before the left half of the fruit, as seen from the robot
  add_patch(wall, {-0.1, 0.4, 0.2}, Vector3d::UnitX(), Vector3d::UnitZ(), 0.24, 0.4);
  const Picking open = plan_picking({fruit}, among({}))[0], pick = plan_picking({fruit}, among(wall))[0];
  CHECK(open.crossed == 0.0);
  CHECK(pick.crossed == 0.0);
  CHECK(pick.reason == PickingReason::not_tested);
  CHECK(pick.direction.x() < -0.15);  // from the right
  CHECK(area_inside(surface_pieces(wall), swept_gripper(occupied(fruit), open.direction, {})) > 1e-4);
  PickingParameters p;
  p.clear_weight = 0.0;
  CHECK(plan_picking({fruit}, among(wall), {}, p)[0].direction == open.direction);
  CHECK(plan_picking({fruit}, among(wall), {}, p)[0].crossed > 1e-4);
}

TEST_CASE("surroundings: a fruit in a bowl is approached through its opening") {
  const Fruit fruit = ball(1, {0.0, 0.5, 0.2});
  for (const Vector3d& open : {Vector3d(0, -1, 0), Vector3d(1, -1, 0), Vector3d(-1, 0, 0.2), Vector3d(0.3, 0, -1)}) {
    const Vector3d side = open.normalized();
    const Cloud shell = bowl(fruit.body->center, side, deg(35));
    INFO("open towards " << side.transpose());
    const Picking pick = plan_picking({fruit}, among(shell))[0];
    CHECK(-pick.direction.dot(side) > std::cos(deg(25)));
    CHECK(pick.crossed < 1e-4);
    // In any order of the points.
    CHECK(same_plan({pick}, plan_picking({fruit}, among(reordered(shell, 5)))));
  }
}

TEST_CASE("surroundings: beyond the limit a direction is not taken") {
  const Fruit fruit = ball(1, {0.0, 0.5, 0.2});
  const Cloud closed = bowl(fruit.body->center, Vector3d::UnitY(), 0.0);
  PickingParameters p;
  const Picking through = plan_picking({fruit}, among(closed), {}, p)[0];
  CHECK(through.reason == PickingReason::not_tested);
  const double section = kPi * p.gripper_radius * p.gripper_radius;
  CHECK(through.crossed > 0.8 * section);
  CHECK(through.crossed < 1.4 * section);
  p.max_crossed = 0.5 * section;
  const Picking blocked = plan_picking({fruit}, among(closed), {}, p)[0];
  CHECK(blocked.reason == PickingReason::blocked_by_surroundings);
  CHECK_FALSE(blocked.reachable);
  CHECK(blocked.crossed > p.max_crossed);
  CHECK(blocked.direction.norm() == Approx(1.0));
  p.max_crossed = through.crossed;
  CHECK(plan_picking({fruit}, among(closed), {}, p)[0].reason == PickingReason::not_tested);
  // None may be crossed, and the arm can follow only what comes from the right: there the bowl is open, or is not.
  const ReachApproach from_the_right = [](const ApproachRequest& request, const Joints&) -> ApproachAnswer {
    if (request.direction.x() > -0.8) return {std::nullopt, PickingReason::out_of_reach};
    return {ReachableApproach{look_along(request.start, request.direction), std::nullopt}, PickingReason::reachable};
  };
  p.max_crossed = 0.0;
  CHECK(plan_picking({fruit}, among(closed), {}, p)[0].reason == PickingReason::blocked_by_surroundings);
  for (const double x : {1.0, -1.0}) {
    const Cloud half = bowl(fruit.body->center, {x, 0, 0}, deg(60));
    const Picking pick = plan_picking({fruit}, among(half), from_the_right, p)[0];
    CHECK(pick.reason == (x > 0.0 ? PickingReason::reachable : PickingReason::out_of_reach));
    CHECK(pick.crossed == 0.0);
  }
  // A space to keep out of is told first.
  PickingScene walled = among(closed);
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {-1.0, 1.0}) {
      Vector3d size(0.3, 0.3, 0.3), center = fruit.body->center;
      size[axis] = 0.05;
      center[axis] += 0.1 * at;
      walled.keep_out.push_back({"wall", Box{center, size}});
    }
  CHECK(plan_picking({fruit}, walled, {}, p)[0].reason == PickingReason::blocked_by_keep_out);
}

TEST_CASE("surroundings: a fruit that would be picked through a tray waits until its neighbor is picked") {
  // The second fruit is behind the first, and below a sheet. The arm reaches them from the front and from above.
  const std::vector<Fruit> fruits{ball(1, {0.0, 0.5, 0.2}), ball(2, {0.0, 0.6, 0.2})};
  Cloud sheet;
  add_patch(sheet, {0.0, 0.6, 0.28}, Vector3d::UnitX(), Vector3d::UnitY(), 0.1, 0.09);
  const ReachApproach front_or_above = [](const ApproachRequest& request, const Joints&) -> ApproachAnswer {
    if (request.direction.y() < 0.95 && request.direction.z() > -0.8)
      return {std::nullopt, PickingReason::out_of_reach};
    return {ReachableApproach{look_along(request.start, request.direction), std::nullopt}, PickingReason::reachable};
  };
  PickingParameters p;
  p.pedicel_angle = 0.0;
  const auto plan = plan_picking(fruits, among(sheet), front_or_above, p);
  CHECK(plan[1].reachable);
  CHECK(plan[1].order == 2);
  CHECK(plan[1].after == std::vector<int>{1});
  CHECK(plan[1].crossed == 0.0);
  p.clear_weight = 0.0;
  const auto careless = plan_picking(fruits, among(sheet), front_or_above, p);
  CHECK(careless[1].after.empty());
  CHECK(careless[1].crossed > 3e-4);
  // What cannot become free is picked through the sheet.
  p.clear_weight = 2.0;
  const ReachApproach above = [](const ApproachRequest& request, const Joints&) -> ApproachAnswer {
    if (request.direction.z() > -0.8) return {std::nullopt, PickingReason::out_of_reach};
    return {ReachableApproach{look_along(request.start, request.direction), std::nullopt}, PickingReason::reachable};
  };
  const auto through = plan_picking(fruits, among(sheet), above, p);
  CHECK(through[1].reachable);
  CHECK(through[1].order == 2);
  CHECK(through[1].crossed > 3e-4);
}

TEST_CASE("surroundings: the arm is not asked again before another fruit is picked") {
  const std::vector<Fruit> fruits{ball(1, {0.0, 0.5, 0.2}), ball(2, {0.0, 0.7, 0.2})};
  Cloud shell = bowl(fruits[0].body->center, Vector3d::UnitY(), deg(60));
  std::size_t asked = 0;
  const ReachApproach never = [&](const ApproachRequest&, const Joints&) -> ApproachAnswer {
    ++asked;
    return {std::nullopt, PickingReason::arm_meets_fruit};
  };
  PickingParameters p;
  const auto plan = plan_picking(fruits, among(shell), never, p);
  CHECK(plan[0].reason == PickingReason::arm_meets_fruit);
  CHECK(asked > static_cast<std::size_t>(p.directions));
  CHECK(asked <= 2 * static_cast<std::size_t>(p.directions));
}

TEST_CASE("surroundings: points on the fruit, its neighbors and far away change nothing") {
  const std::vector<Fruit> fruits{ball(1, {0.0, 0.5, 0.2}), ball(2, {0.09, 0.52, 0.22}), ball(3, {-0.02, 0.59, 0.15})};
  const auto plain = plan_picking(fruits, among({}));
  for (const Picking& pick : plain) CHECK(pick.crossed == 0.0);
  Cloud cloud;
  for (const Fruit& f : fruits)
    for (const Vector3d& d : plan::spread_directions(500))
      cloud.points.push_back((f.body->center + (kBall + 0.002) * d).cast<float>());
  add_patch(cloud, {0.0, 1.5, 0.2}, Vector3d::UnitX(), Vector3d::UnitZ(), 0.1, 0.1, false);
  CHECK(same_plan(plan_picking(fruits, among(cloud)), plain));
  cloud.points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f);
  CHECK(same_plan(plan_picking(fruits, among(cloud)), plain));
  cloud.normals.emplace_back(0.0f, 0.0f, 1.0f);
  CHECK_THROWS_AS(plan_picking(fruits, among(cloud)), InputError);
  // Nor do surroundings change what has no body, or a gripper without thickness.
  Fruit bare = fruits[0];
  bare.body.reset();
  bare.sigma.setConstant(0.02);
  const Cloud shell = bowl(fruits[0].body->center, Vector3d::UnitY(), 0.5);
  CHECK(plan_picking({bare}, among(shell))[0].reason == PickingReason::no_body);
  CHECK(plan_picking({bare}, among(shell))[0].crossed == 0.0);
  PickingParameters thin;
  thin.gripper_radius = 0.0;
  CHECK(same_plan(plan_picking({fruits[0]}, among(shell), {}, thin), plan_picking({fruits[0]}, among({}), {}, thin)));
}

TEST_CASE("surroundings: whatever is measured, as many fruit can be picked as without, unless there is a limit") {
  Rng rng(4);
  for (int round = 0; round < 5; ++round) {
    std::vector<Fruit> fruits;
    for (int i = 0; i < 6; ++i)
      fruits.push_back(ball(i + 1, {0.08 * (i % 3) - 0.08, 0.5 + 0.08 * (i / 3), rng.uniform(0.15, 0.25)}));
    Cloud leaves;
    for (int i = 0; i < 8; ++i) {
      const Vector3d n = rng.direction(), u = n.unitOrthogonal();
      const Vector3d center(rng.uniform(-0.15, 0.15), rng.uniform(0.4, 0.6), rng.uniform(0.1, 0.3));
      add_patch(leaves, center, u, n.cross(u), 0.08, 0.05);
    }
    const ReachApproach upwards = [](const ApproachRequest& request, const Joints&) -> ApproachAnswer {
      if (request.direction.z() < 0.3) return {std::nullopt, PickingReason::out_of_reach};
      return {ReachableApproach{look_along(request.start, request.direction), std::nullopt}, PickingReason::reachable};
    };
    const auto free = plan_picking(fruits, among({}), upwards), crowded = plan_picking(fruits, among(leaves), upwards);
    PickingParameters careless;
    careless.clear_weight = 0.0;
    const auto through = plan_picking(fruits, among(leaves), upwards, careless);
    double crossed = 0.0, before = 0.0;
    for (std::size_t i = 0; i < fruits.size(); ++i) {
      CHECK(crowded[i].reachable == free[i].reachable);
      CHECK(through[i].direction == free[i].direction);
      crossed += crowded[i].crossed;
      before += through[i].crossed;
    }
    CHECK(crossed <= before);
  }
}
