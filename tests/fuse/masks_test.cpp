// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/masks.hpp>
#include <agrisee/fuse/paint.hpp>

#include <thread>
#include <tuple>

#include "catch.hpp"

using namespace agrisee;

namespace masks_test {

namespace {

/// A ball (m, world) before a wall at z = 2 m.
struct Ball {
  Eigen::Vector3d center;
  double radius;
};

/// What a camera of 400 x 300 pixels sees of balls, each with a mask numbered from 1. What is nearer than `cover` (m)
/// in columns from `covered_from` on is a leaf, which hides the balls.
fuse::DetectedView view_of(const std::vector<Ball>& balls, const Pose& world_T_optical = Pose::Identity(),
                           int covered_from = 400, double cover = 0.7) {
  sensor::DepthFrame f;
  f.intrinsics = {400, 300, 600.0, 600.0, 199.5, 149.5};
  f.detected = true;
  const Eigen::Vector3d sensor = world_T_optical.translation();
  for (int v = 0; v < 300; ++v)
    for (int u = 0; u < 400; ++u) {
      const Eigen::Vector3d ray = f.intrinsics.ray(u, v), d = world_T_optical.linear() * ray;
      double z = 2.0;
      std::uint16_t instance = 0;
      for (std::size_t b = 0; b < balls.size(); ++b) {
        const Eigen::Vector3d to = balls[b].center - sensor;
        const double t = to.dot(d) / d.squaredNorm();
        const double inside = balls[b].radius * balls[b].radius - (to - t * d).squaredNorm();
        if (inside < 0.0) continue;
        const double depth = t - std::sqrt(inside / d.squaredNorm());
        if (depth < z) z = depth, instance = static_cast<std::uint16_t>(b + 1);
      }
      if (u >= covered_from) z = cover, instance = 0;
      f.depth.push_back(static_cast<float>(z));
      f.instances.push_back(instance);
    }
  return {std::move(f), world_T_optical};
}

BodyParameters apples() {
  BodyParameters bodies;
  bodies.radius_min = 0.02;
  bodies.radius_max = 0.06;
  return bodies;
}

const Ball kLeft{{-0.1, 0.02, 1.0}, 0.035}, kRight{{0.12, -0.03, 1.1}, 0.045};

/// A view of a ball that returns nothing where sight lines pass its center at less than a share of its radius.
sensor::DepthFrame rim_of(const Ball& ball, double share) {
  sensor::DepthFrame f = *view_of({ball}).frame;
  for (int v = 0; v < 300; ++v)
    for (int u = 0; u < 400; ++u) {
      const Eigen::Vector3d d = f.intrinsics.ray(u, v).normalized();
      if (ball.center.cross(d).norm() < share * ball.radius) f.depth[f.intrinsics.index(u, v)] = 0.0f;
    }
  return f;
}

/// A ball so small beside its distance that all its sight lines are nearly parallel.
const Ball kFar{{0.2, -0.1, 10.0}, 0.05};

/// A view of it in which depths bulge `bulge` times as much as it does, and every second one is off by -+`off` (m).
sensor::DepthFrame bulging(double bulge, double off = 0.0) {
  sensor::DepthFrame f;
  f.intrinsics = {120, 100, 6000.0, 6000.0, 59.5 - 120.0, 49.5 + 60.0};
  f.detected = true;
  for (int v = 0; v < 100; ++v)
    for (int u = 0; u < 120; ++u) {
      const Eigen::Vector3d ray = f.intrinsics.ray(u, v).normalized();
      const double middle = kFar.center.dot(ray),
                   inside = std::pow(kFar.radius, 2) - kFar.center.squaredNorm() + middle * middle;
      const double z = middle - bulge * std::sqrt(std::max(0.0, inside)) + ((u + v) % 2 ? off : -off);
      f.depth.push_back(static_cast<float>(inside > 0.0 ? z * ray.z() : 0.0));
      f.instances.push_back(inside > 0.0);
    }
  return f;
}

constexpr double kRim = 0.87;  // of the radius: depths nearer to the rim do not count

/// The odds of one mask with this score.
double odds_of(double score) { return 0.5 * std::log(score / (1.0 - score)); }

}  // namespace

TEST_CASE("masks propose the bodies under them") {
  const std::vector<fuse::DetectedView> views{view_of({kLeft, kRight})};
  const auto evidence = fuse::mask_evidence(views, apples());
  REQUIRE(evidence.bodies.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const Ball& ball = i == 0 ? kLeft : kRight;
    const Ellipsoid& body = evidence.bodies[i].fit.body;
    CHECK((body.center - ball.center).norm() < 0.003);
    CHECK(body.mean_radius() == Approx(ball.radius).margin(0.0008));
    CHECK(evidence.bodies[i].log_odds > 2.0);
    CHECK(evidence.log_odds(body) > 1.0);
  }
  CHECK(evidence.log_odds(Ellipsoid(Sphere{{0.0, 0.0, 5.0}, 0.04})) == 0.0);   // behind the wall: not shown
  CHECK(evidence.log_odds(Ellipsoid(Sphere{{0.0, 0.1, 2.04}, 0.04})) < -0.3);  // on the wall, where there is no mask
}

TEST_CASE("a body that is half hidden keeps its size") {
  const double middle = 199.5 + 600.0 * kLeft.center.x() / kLeft.center.z();
  for (const double hidden : {0.0, 8.0}) {  // pixels beyond its middle
    const auto evidence =
        fuse::mask_evidence({view_of({kLeft}, Pose::Identity(), static_cast<int>(middle + hidden))}, apples());
    REQUIRE(evidence.bodies.size() == 1);
    CHECK(evidence.bodies[0].fit.body.mean_radius() == Approx(kLeft.radius).epsilon(0.08));
    CHECK((evidence.bodies[0].fit.body.center - kLeft.center).norm() < 0.006);
  }
}

TEST_CASE("a box stands for a mask") {
  sensor::DepthFrame frame = *view_of({kLeft}).frame;
  int u0 = 400, v0 = 300, u1 = 0, v1 = 0;
  for (int v = 0; v < 300; ++v)
    for (int u = 0; u < 400; ++u)
      if (frame.instances[static_cast<std::size_t>(400 * v + u)])
        u0 = std::min(u0, u), u1 = std::max(u1, u), v0 = std::min(v0, v), v1 = std::max(v1, v);
  frame.instances.clear();
  sensor::Detection d;
  d.instance = 9;
  d.box = sensor::PixelBox{double(u0), double(v0), u1 - u0 + 1.0, v1 - v0 + 1.0};
  frame.detections = {d};
  const auto evidence = fuse::mask_evidence({{frame, Pose::Identity()}}, apples());
  REQUIRE(evidence.bodies.size() == 1);
  CHECK(evidence.bodies[0].fit.body.mean_radius() == Approx(kLeft.radius).margin(0.001));
  CHECK(evidence.bodies[0].log_odds == Approx(odds_of(0.95) + 12.7 + 1.75 + 1.0 - 8.0).margin(0.4));
  CHECK(evidence.most == 4.0);
  frame.detections.push_back(d);
  CHECK_THROWS_WITH(fuse::mask_evidence({{frame, Pose::Identity()}}, apples()), Catch::Contains("listed twice"));
}

TEST_CASE("a box adds its ellipse where a detection has no mask") {
  sensor::DepthFrame frame;
  frame.intrinsics = {7, 3, 1.0, 1.0, 0.0, 0.0};
  frame.depth.assign(21, 1.0f);
  frame.instances.assign(21, 0);
  frame.instances[1] = 5;  // a mask, so its box does not count
  for (const auto& [instance, score, u] : {std::tuple(5, 1.0, 0.0), std::tuple(6, 0.5, 2.0), std::tuple(7, 0.9, 4.0)}) {
    sensor::Detection d;
    d.instance = instance;
    d.score = score;
    d.box = sensor::PixelBox{u, 0.0, 3.0, 3.0};
    frame.detections.push_back(d);
  }
  // So small an ellipse has all pixels of its box; where two overlap the larger score wins.
  CHECK(fuse::instances_of(frame) == std::vector<std::uint16_t>{0, 5, 6, 6, 7, 7, 7,  //
                                                                0, 0, 6, 6, 7, 7, 7,  //
                                                                0, 0, 6, 6, 7, 7, 7});
}

TEST_CASE("masks of several views propose one body together") {
  Pose aside = Pose::Identity();
  aside.translation() = Eigen::Vector3d(0.15, 0.0, 0.1);
  const std::vector<fuse::DetectedView> views{view_of({kLeft}), view_of({kLeft}, aside)};
  const auto evidence = fuse::mask_evidence(views, apples());
  REQUIRE(evidence.bodies.size() == 1);
  CHECK((evidence.bodies[0].fit.body.center - kLeft.center).norm() < 0.002);
  const auto alone = fuse::mask_evidence({views[0]}, apples());
  CHECK(evidence.bodies[0].fit.center_covariance.trace() < alone.bodies[0].fit.center_covariance.trace());
}

TEST_CASE("of the masks of a view one joins the body of another view") {
  Pose aside = Pose::Identity();
  aside.translation() = Eigen::Vector3d(0.15, 0.0, 0.1);
  const fuse::DetectedView view = view_of({kLeft}), other = view_of({kLeft}, aside);
  sensor::DepthFrame torn = *other.frame;  // the detector saw two fruit
  const int middle = static_cast<int>(torn.intrinsics.project(aside.inverse() * kLeft.center).x());
  for (int v = 0; v < 300; ++v)
    for (int u = middle; u < 400; ++u) {
      std::uint16_t& instance = torn.instances[torn.intrinsics.index(u, v)];
      if (instance == 1) instance = 2;
    }
  sensor::DepthFrame half = torn;
  for (std::uint16_t& instance : half.instances)
    if (instance == 2) instance = 0;
  const auto with_half = fuse::mask_evidence({view, {half, aside}}, apples());
  const auto with_both = fuse::mask_evidence({view, {torn, aside}}, apples());
  REQUIRE(with_half.bodies.size() == 1);
  REQUIRE(with_both.bodies.size() == 2);
  CHECK(with_both.bodies[0].fit.body.center == with_half.bodies[0].fit.body.center);
  CHECK(with_both.bodies[0].fit.inliers == with_half.bodies[0].fit.inliers);
}

TEST_CASE("without depths under a mask its score is all there is") {
  const auto evidence = fuse::mask_evidence({{rim_of(kLeft, 0.95), Pose::Identity()}}, apples());
  REQUIRE(evidence.bodies.size() == 1);
  CHECK(evidence.bodies[0].log_odds == Approx(0.5 * std::log(0.95 / 0.05) - 8.0));
}

TEST_CASE("the depths under all masks of a body count alike, pixels without depth half") {
  Pose aside = Pose::Identity();
  aside.translation() = Eigen::Vector3d(0.15, 0.0, 0.1);
  sensor::DepthFrame half = *view_of({kLeft}, aside).frame;
  for (int v = 0; v < 300; ++v)
    for (int u = v % 2; u < 400; u += 2) half.depth[half.intrinsics.index(u, v)] = 0.0f;
  const auto evidence = fuse::mask_evidence({view_of({kLeft}), {half, aside}}, apples());
  REQUIRE(evidence.bodies.size() == 1);
  const double scores = 2.0 * 0.5 * std::log(0.95 / 0.05) / std::sqrt(2.0), agreement = 0.5 * (1.0 + 0.5 / 0.75);
  CHECK(evidence.bodies[0].log_odds == Approx(scores + 12.7 * agreement + 1.75 - 8.0).margin(0.3));
}

TEST_CASE("a mask proposes a body from twelve depths on") {
  const auto proposed = [](int depths) {
    sensor::DepthFrame frame = *view_of({kLeft}).frame;
    const sensor::DepthFrame inner = rim_of(kLeft, 0.3);
    for (std::size_t i = 0; i < frame.depth.size(); ++i)
      if (frame.instances[i] && (inner.depth[i] > 0.0f || --depths < 0)) frame.depth[i] = 0.0f;
    return fuse::mask_evidence({{frame, Pose::Identity()}}, apples()).bodies.size();
  };
  CHECK(proposed(11) == 0);
  CHECK(proposed(12) == 1);
}

TEST_CASE("a mask with the outline of two bodies that touch proposes both") {
  const Ball left{{-0.035, 0.01, 1.0}, 0.035}, right{{0.022, 0.01, 0.987}, 0.022};  // their fronts are equally far
  sensor::DepthFrame frame = *view_of({left, right}).frame;
  for (std::uint16_t& i : frame.instances) i = i ? 1 : 0;
  const auto evidence = fuse::mask_evidence({{frame, Pose::Identity()}}, apples());
  REQUIRE(evidence.bodies.size() == 2);
  const std::size_t first = evidence.bodies[0].fit.body.center.x() < 0.0 ? 0 : 1;
  const Ellipsoid &a = evidence.bodies[first].fit.body, &b = evidence.bodies[1 - first].fit.body;
  CHECK((a.center - left.center).norm() < 0.003);
  CHECK((b.center - right.center).norm() < 0.003);
  CHECK(a.mean_radius() == Approx(left.radius).margin(0.001));
  CHECK(b.mean_radius() == Approx(right.radius).margin(0.001));
}

TEST_CASE("with points first, masks that a body explains propose nothing") {
  const fuse::DetectedView view = view_of({kLeft, kRight});
  fuse::DetectedView read = view;
  read.masks = fuse::read_masks(view, apples());
  for (const fuse::DetectedView& v : {view, read}) {
    const auto evidence = fuse::mask_evidence({v}, apples(), {}, fuse::MaskOrder::points_first);
    CHECK(evidence.bodies.empty());
    REQUIRE(evidence.remaining);
    CHECK(evidence.remaining({}).size() == 2);
    const auto rest = evidence.remaining({Ellipsoid(Sphere{kLeft.center, kLeft.radius})});
    REQUIRE(rest.size() == 1);
    CHECK((rest[0].fit.body.center - kRight.center).norm() < 0.003);
    CHECK(evidence.log_odds(rest[0].fit.body) > 0.0);
  }
}

TEST_CASE("a tail of a mask is no second body") {
  sensor::DepthFrame frame = *view_of({kLeft}).frame;
  for (int v = 158; v <= 164; ++v)  // from its center at (139.5, 161.5) to as far outside as it is wide
    for (int u = 139; u < 185; ++u) frame.instances[frame.intrinsics.index(u, v)] = 1;
  const auto evidence = fuse::mask_evidence({{frame, Pose::Identity()}}, apples());
  REQUIRE(evidence.bodies.size() == 1);
  CHECK((evidence.bodies[0].fit.body.center - kLeft.center).norm() < 0.003);
  CHECK(evidence.bodies[0].fit.body.mean_radius() == Approx(kLeft.radius).margin(0.001));
}

TEST_CASE("a stalk of a mask makes no large body that one sees through") {
  const Ball near{{-0.08, 0.0, 0.5}, 0.0375};  // 45 pixels
  sensor::DepthFrame frame = *view_of({near}).frame;
  for (int v = 148; v <= 150; ++v)
    for (int u = 103; u < 270; ++u) frame.instances[frame.intrinsics.index(u, v)] = 1;
  BodyParameters large = apples();
  large.radius_max = 0.1;
  const auto evidence = fuse::mask_evidence({{frame, Pose::Identity()}}, large);
  REQUIRE(evidence.bodies.size() == 1);
  CHECK((evidence.bodies[0].fit.body.center - near.center).norm() < 0.003);
  CHECK(evidence.bodies[0].fit.body.mean_radius() == Approx(near.radius).margin(0.001));
}

TEST_CASE("depths overrule a mask on a wall") {
  sensor::DepthFrame frame = *view_of({kLeft}).frame;
  std::fill(frame.depth.begin(), frame.depth.end(), 1.0f);
  const auto evidence = fuse::mask_evidence({{frame, Pose::Identity()}}, apples());
  for (const MaskBody& m : evidence.bodies) CHECK(m.log_odds < -1.0);
}

TEST_CASE("classes that are no fruit propose nothing and speak against a body, scores say how much") {
  sensor::DepthFrame frame = *view_of({kLeft}).frame;
  const Ellipsoid body(Sphere{kLeft.center, kLeft.radius});
  double before = 10.0;
  for (const double score : {0.99, 0.8, 0.5, 0.2}) {
    sensor::Detection d;
    d.instance = 1;
    d.score = score;
    frame.detections = {d};
    const std::vector<fuse::DetectedView> views{{frame, Pose::Identity()}};
    const double odds = fuse::mask_evidence(views, apples()).log_odds(body);
    CHECK(odds < before);
    before = odds;
  }
  frame.detections[0].fruit = false;
  frame.detections[0].score = 0.9;
  const std::vector<fuse::DetectedView> views{{frame, Pose::Identity()}};
  const auto evidence = fuse::mask_evidence(views, apples());
  CHECK(evidence.bodies.empty());
  CHECK(evidence.log_odds(body) < -1.0);
}

TEST_CASE("views that no detector looked at say nothing") {
  sensor::DepthFrame frame = *view_of({kLeft}).frame;
  frame.detected = false;
  const auto evidence = fuse::mask_evidence({{frame, Pose::Identity()}}, apples());
  CHECK(evidence.bodies.empty());
  CHECK_FALSE(evidence.log_odds);
}

TEST_CASE("a cloud takes the colors that views saw, and only those") {
  sensor::DepthFrame frame = *view_of({kLeft}).frame;
  for (const std::uint16_t i : frame.instances) frame.color.push_back(i ? Rgb{200, 10, 20} : Rgb{10, 200, 20});
  Cloud cloud;
  cloud.points = {(kLeft.center - kLeft.radius * kLeft.center.normalized()).cast<float>(),
                  {0.0f, 0.2f, 2.0f},
                  {0.0f, 0.0f, 1.5f},
                  {0.0f, 0.0f, -1.0f}};
  const std::vector<Rgb> colors = fuse::colors_of(cloud, {{frame, Pose::Identity()}});
  CHECK(colors == std::vector<Rgb>{{200, 10, 20}, {10, 200, 20}, {0, 0, 0}, {0, 0, 0}});
  frame.color.pop_back();
  CHECK_THROWS_AS(fuse::colors_of(cloud, {{frame, Pose::Identity()}}), InputError);
  frame.color.clear();
  CHECK(fuse::colors_of(cloud, {{frame, Pose::Identity()}}).empty());
}

TEST_CASE("a proposal is judged by how its depths bulge and how many agree") {
  // In units of the radius the body is s = sqrt(1 - x x) deep, and s s is evenly distributed from the rim to 1. A bulge
  // of b is |b - 1| s off. Within 0.4 are most between 1 - 0.4 / |b - 1| and 1.
  const double rim = 1.0 - kRim * kRim;
  for (const double bulge : {-2.0, 0.0, 0.3, 0.5, 1.0, 1.5, 2.0, 3.5}) {
    const double least = bulge == 1.0 ? 0.0 : 1.0 - 0.4 / std::abs(bulge - 1.0);
    const double agreement = least * least > rim && least > 0.0 ? (1.0 - least * least) / (1.0 - rim) : 1.0;
    const double flatness = std::max(0.0, 0.4 - bulge), limited = std::clamp(bulge, -1.0, 3.0);
    const auto evidence = fuse::mask_evidence({{bulging(bulge), Pose::Identity()}}, apples());
    REQUIRE(evidence.bodies.size() == 1);
    INFO("bulge " << bulge);
    CHECK(evidence.bodies[0].log_odds ==
          Approx(odds_of(0.95) + 12.7 * agreement + 1.75 * limited - 20.0 * flatness - 8.0).margin(0.45));
  }
}

TEST_CASE("a flat mask is less surely flat where its depths scatter") {
  // s has the variance 1/2 (1 + rim) - (2/3 (1 - rim^3/2) / (1 - rim))^2. Twenty depths count.
  const double rim = 1.0 - kRim * kRim, mean = 2.0 / 3.0 * (1.0 - std::pow(rim, 1.5)) / (1.0 - rim);
  const double variance = 0.5 * (1.0 + rim) - mean * mean;
  for (const double off : {0.02, 0.05}) {  // of the radius
    const double error = off / std::sqrt(20.0 * variance);
    // Half of the depths are nearer and half farther: between 0.6 - off and 1 - off are most.
    const double nearer = 1.0 - 0.6 * 0.6, farther = std::pow(1.0 - 2.0 * off, 2) - std::pow(0.6 - 2.0 * off, 2);
    const double agreement = 0.5 * (nearer + farther) / (1.0 - rim);
    const auto evidence = fuse::mask_evidence({{bulging(0.0, off * kFar.radius), Pose::Identity()}}, apples());
    REQUIRE(evidence.bodies.size() == 1);
    CHECK(evidence.bodies[0].log_odds ==
          Approx(odds_of(0.95) + 12.7 * agreement - 20.0 * (0.4 - 2.0 * error) - 8.0).margin(0.45));
  }
}

TEST_CASE("masks on a known body add the odds of their scores, none adds those of being overlooked") {
  sensor::DepthFrame frame = *view_of({kLeft}).frame;
  const Ellipsoid body(Sphere{kLeft.center, kLeft.radius});
  sensor::Detection d;
  d.instance = 1;
  fuse::MaskParameters parameters;
  const auto odds = [&](std::size_t views = 1) {
    frame.detections = {d};
    return fuse::mask_evidence(std::vector<fuse::DetectedView>(views, {frame, Pose::Identity()}), apples(), parameters)
        .log_odds(body);
  };
  for (const double score : {0.6, 0.9, 0.1}) {
    d.score = score;
    CHECK(odds() == Approx(odds_of(score)).margin(0.05));  // pixels at the rim may be beside the mask
  }
  d.score = 1.0;
  CHECK(odds() == Approx(odds_of(0.95)).margin(0.1));
  d.score = 0.0;
  CHECK(odds() == Approx(odds_of(0.05)).margin(0.1));
  d.score = 0.9;
  d.fruit = false;
  CHECK(odds() == Approx(-odds_of(0.9)).margin(0.1));
  CHECK(odds(3) == Approx(-odds_of(0.9) * std::sqrt(3.0)).margin(0.1));
  CHECK(odds(9) == Approx(-odds_of(0.9) * 3.0).margin(0.3));
  CHECK(odds(25) == -4.0);
  parameters.max_log_odds = 2.5;
  CHECK(odds(25) == -2.5);
  d.fruit = true;
  CHECK(odds(25) == 2.5);
  std::fill(frame.instances.begin(), frame.instances.end(), std::uint16_t(0));
  for (const double recall : {0.0, 0.5, 0.8}) {
    parameters.recall = recall;
    CHECK(odds() == Approx(std::log(1.0 - recall)).margin(1e-9));
  }
  for (int v = 0; v < 300; ++v)  // the left half alone
    for (int u = 0; u < 140; ++u) frame.instances[frame.intrinsics.index(u, v)] = 1;
  parameters = {};
  CHECK(odds() == Approx(0.5 * (odds_of(0.9) + std::log(0.5))).margin(0.1));
}

TEST_CASE("bodies whose depths are not theirs are not shown") {
  const fuse::DetectedView view = view_of({kLeft});
  const auto evidence = fuse::mask_evidence({view}, apples());
  const Eigen::Vector3d sight = kLeft.center.normalized();
  const auto at = [&](double farther) {  // of its radius
    return evidence.log_odds(Ellipsoid(Sphere{kLeft.center + farther * kLeft.radius * sight, kLeft.radius}));
  };
  for (const double sign : {-1.0, 1.0}) {
    CHECK(at(0.25 * sign) > 1.0);
    CHECK(at(0.6 * sign) < 1.0);  // at the rim at most
    CHECK(at(1.5 * sign) == 0.0);
  }
}

TEST_CASE("a fruit of which little is seen is expected to be like the others") {
  std::vector<Ball> balls;
  for (int i = 0; i < 5; ++i) balls.push_back({{-0.24 + 0.1 * i, -0.12, 1.0}, 0.03 + 0.0001 * i});
  balls.push_back({{0.1, 0.1, 1.0}, 0.03});
  sensor::DepthFrame frame = *view_of(balls).frame;
  for (int v = 160; v < 300; ++v)  // a leaf leaves the left third of the last
    for (int u = 253; u < 400; ++u) {
      frame.depth[frame.intrinsics.index(u, v)] = 0.7f;
      frame.instances[frame.intrinsics.index(u, v)] = 0;
    }
  const auto last = [&](bool alike, std::size_t others) {
    sensor::DepthFrame some = frame;
    for (std::uint16_t& i : some.instances)
      if (i > others && i < 6) i = 0;
    fuse::MaskParameters parameters;
    parameters.alike = alike;
    const auto evidence = fuse::mask_evidence({{some, Pose::Identity()}}, apples(), parameters);
    REQUIRE(evidence.bodies.size() == others + 1);
    return evidence.bodies.back().fit;
  };
  const EllipsoidFit alike = last(true, 5), alone = last(false, 5), few = last(true, 4);
  CHECK(alike.body.mean_radius() == Approx(0.0302).margin(0.003));
  CHECK(alike.shape_covariance(0, 0) < 0.9 * alone.shape_covariance(0, 0));
  CHECK(few.body.mean_radius() == alone.body.mean_radius());
}

TEST_CASE("a body explains a mask if at least half of its pixels show it") {
  for (const int columns : {22, 44}) {  // of the wall beside it, 42 pixels high; of the ball there are 1380 pixels
    sensor::DepthFrame frame = *view_of({kLeft}).frame;
    for (int v = 140; v < 182; ++v)
      for (int u = 200; u < 200 + columns; ++u) frame.instances[frame.intrinsics.index(u, v)] = 1;
    const auto evidence = fuse::mask_evidence({{frame, Pose::Identity()}}, apples(), {}, fuse::MaskOrder::points_first);
    CHECK(evidence.remaining({Ellipsoid(Sphere{kLeft.center, kLeft.radius})}).empty() == (columns == 22));
  }
}

TEST_CASE("a body explains a mask if at least half of the pixels that have a depth show it") {
  BodyParameters bodies = apples();
  bodies.radius_min = 0.004;
  const auto explained = [&](int on, int off) {  // of 52 pixels so many show the ball or the wall
    sensor::DepthFrame frame = *view_of({kLeft}).frame;
    for (int v = 0; v < 300; ++v)
      for (int u = 0; u < 400; ++u) {
        const std::size_t p = frame.intrinsics.index(u, v);
        frame.instances[p] = std::hypot(u - 139.5, v - 161.5) < 4.0;
        if (!frame.instances[p] || --on >= 0) continue;
        frame.depth[p] = --off >= 0 ? 2.0f : 0.0f;
      }
    const auto evidence = fuse::mask_evidence({{frame, Pose::Identity()}}, bodies, {}, fuse::MaskOrder::points_first);
    return evidence.remaining({Ellipsoid(Sphere{kLeft.center, kLeft.radius})}).empty();
  };
  CHECK(explained(26, 26));
  CHECK_FALSE(explained(25, 26));
  CHECK(explained(13, 13));
  CHECK_FALSE(explained(13, 14));
}

TEST_CASE("what masks say of a body does not depend on the scale") {
  const auto odds = [](float scale) {
    sensor::DepthFrame frame = *view_of({kLeft}).frame;
    for (float& z : frame.depth) z *= scale;
    const Sphere ball{double(scale) * kLeft.center, double(scale) * kLeft.radius};
    return fuse::mask_evidence({{frame, Pose::Identity()}}, apples()).log_odds(Ellipsoid(ball));
  };
  CHECK(odds(1.0f) > 1.0);
  for (const float scale : {1.0f / 1024, 1.0f / 32, 32.0f}) CHECK(odds(scale) == Approx(odds(1.0f)));
}

TEST_CASE("threads may use the masks of one view at the same time") {  // the thread sanitizer would tell otherwise
  std::vector<Ball> balls;
  for (int i = 0; i < 5; ++i) balls.push_back({{-0.2 + 0.1 * i, 0.02 * i, 1.0}, 0.03});
  const fuse::DetectedView alone = view_of(balls);
  fuse::DetectedView shared = alone;
  shared.masks = fuse::read_masks(shared, apples());
  const auto expected = fuse::mask_evidence({alone}, apples());
  REQUIRE(expected.bodies.size() == balls.size());
  std::vector<MaskEvidence> found(4);
  std::vector<std::thread> threads;
  for (MaskEvidence& f : found) threads.emplace_back([&] { f = fuse::mask_evidence({shared}, apples()); });
  for (std::thread& t : threads) t.join();
  for (const MaskEvidence& f : found) {
    REQUIRE(f.bodies.size() == expected.bodies.size());
    for (std::size_t i = 0; i < f.bodies.size(); ++i) {
      CHECK(f.bodies[i].fit.body.center == expected.bodies[i].fit.body.center);
      CHECK(f.bodies[i].fit.body.A == expected.bodies[i].fit.body.A);
      CHECK(f.bodies[i].log_odds == expected.bodies[i].log_odds);
    }
  }
}

TEST_CASE("wrong parameters and poses that are not rigid are refused") {
  const fuse::DetectedView view = view_of({kLeft});
  fuse::MaskParameters parameters;
  parameters.edge = 0.0;
  CHECK_THROWS_AS(fuse::mask_evidence({view}, apples(), parameters), ParameterError);
  CHECK_THROWS_AS(fuse::read_masks(view, apples(), parameters), ParameterError);
  BodyParameters bodies = apples();
  bodies.radius_min = 0.0;
  CHECK_THROWS_AS(fuse::mask_evidence({view}, bodies), ParameterError);
  CHECK_THROWS_AS(fuse::read_masks(view, bodies), ParameterError);
  fuse::DetectedView bent = view;
  bent.world_T_optical.linear() *= 1.1;
  CHECK_THROWS_AS(fuse::mask_evidence({bent}, apples()), InputError);
  CHECK_THROWS_WITH(fuse::read_masks({}, apples()), Catch::Contains("has no frame"));
}

}  // namespace masks_test
