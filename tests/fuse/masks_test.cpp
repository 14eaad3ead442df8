// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/masks.hpp>
#include <agrisee/fuse/paint.hpp>
#include <agrisee/fuse/silhouette.hpp>

#include "catch.hpp"

using namespace agrisee;

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
  frame.detections.push_back(d);
  CHECK_THROWS_WITH(fuse::mask_evidence({{frame, Pose::Identity()}}, apples()), Catch::Contains("listed twice"));
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

TEST_CASE("an ellipsoid is fitted to its outline") {
  Ellipsoid body;
  body.center = {0.1, -0.05, 0.9};
  body.A = Eigen::Vector3d(1 / 0.040, 1 / 0.032, 1 / 0.036).asDiagonal();
  fuse::Silhouette outline;
  outline.angle_error = 2e-3;
  for (int i = 0; i < 90; ++i) {  // rays that graze it: bisect between the center and far outside
    const double turn = kTwoPi * i / 90;
    const Eigen::Vector3d aside(std::cos(turn), std::sin(turn), 0.0);
    double in = 0.0, out = 0.1;
    for (int step = 0; step < 50; ++step) {
      const double middle = 0.5 * (in + out);
      const Eigen::Vector3d d = (body.center + middle * aside).normalized();
      const Eigen::Vector3d a = body.A * d, c = body.A * body.center;
      const double nearest = (c - a * (a.dot(c) / a.squaredNorm())).norm();
      (nearest < 1.0 ? in : out) = middle;
    }
    outline.rays.push_back((body.center + in * aside).normalized());
    outline.weights.push_back(1.0);
  }
  outline.front.push_back(body.surface(-body.center.normalized()));
  const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(Sphere{body.center * 1.003, 0.036}), std::nullopt, 0.3);
  REQUIRE(fit);
  CHECK((fit->body.center - body.center).norm() < 0.002);
  const Eigen::Vector3d axes = semi_axes(fit->body).first;
  CHECK(axes[0] == Approx(0.040).margin(0.001));
  CHECK(axes[2] == Approx(0.032).margin(0.001));
  const auto drawn =
      fuse::fit_silhouettes({outline}, Ellipsoid(Sphere{body.center, 0.036}), fuse::ExpectedRadius{0.04, 1e-4}, 0.3);
  REQUIRE(drawn);
  CHECK(drawn->body.mean_radius() > fit->body.mean_radius() + 0.002);
}

TEST_CASE("a cloud takes the colours that views saw, and only those") {
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
