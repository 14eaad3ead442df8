// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/silhouette.hpp>

#include "catch.hpp"

using namespace agrisee;

namespace silhouette_test {

namespace {

/// An ellipsoid with semi-axes of 40, 32 and 36 mm.
Ellipsoid egg() {
  Ellipsoid body;
  body.center = {0.1, -0.05, 0.9};
  body.A = Eigen::Vector3d(1 / 0.040, 1 / 0.032, 1 / 0.036).asDiagonal();
  return body;
}

/// Its outline from the origin: rays that graze it, found by bisection between its center and far outside.
fuse::Silhouette outline_of_egg() {
  const Ellipsoid body = egg();
  fuse::Silhouette outline;
  outline.angle_error = 2e-3;
  for (int i = 0; i < 90; ++i) {
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
  return outline;
}

/// The outline of a ball in the direction z from the sensor, as exactly known as 1/500 of its distance.
/// @param turned   how far each ray is outside of the ball (rad), the other way for every second one
fuse::Silhouette outline_of_ball(const Sphere& ball, const Eigen::Vector3d& sensor, double turned = 0.0) {
  constexpr int kRays = 90;
  fuse::Silhouette outline;
  outline.sensor = sensor;
  outline.angle_error = 0.002;
  const double angle = std::asin(ball.radius / (ball.center.z() - sensor.z()));
  for (int i = 0; i < kRays; ++i) {
    const double turn = kTwoPi * i / kRays, open = angle + (i % 2 ? -turned : turned);
    outline.rays.emplace_back(std::sin(open) * std::cos(turn), std::sin(open) * std::sin(turn), std::cos(open));
    outline.weights.push_back(1.0);
  }
  return outline;
}

/// A ball with a radius of 1/25 of its distance, and the part of its front that is nearest.
const Eigen::Vector3d kSensor(0.1, 0.2, -0.3);
const Sphere kBall{{0.1, 0.2, 0.7}, 0.04};
const Eigen::Vector3d kNearest(0.1, 0.2, 0.66);
constexpr double kRigid = 1e-3;  // a prior that leaves nothing but balls

/// Fill the stack below the caller with bytes that make no number.
[[gnu::noinline]] void fill_stack() {
  volatile unsigned char bytes[65536];
  for (volatile unsigned char& byte : bytes) byte = 0xff;
}

bool same(const EllipsoidFit& a, const EllipsoidFit& b) {
  return (a.body.center - b.body.center).norm() < 1e-9 && (a.body.A - b.body.A).norm() < 1e-6 &&
         a.inliers == b.inliers && std::abs(a.rms - b.rms) < 1e-9;
}

}  // namespace

TEST_CASE("an ellipsoid is fitted to its outline") {
  const Ellipsoid body = egg();
  const fuse::Silhouette outline = outline_of_egg();
  const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(Sphere{body.center * 1.003, 0.036}), std::nullopt, 0.3);
  REQUIRE(fit);
  CHECK((fit->body.center - body.center).norm() < 0.002);
  const Eigen::Vector3d axes = semi_axes(fit->body).first;
  CHECK(axes[0] == Approx(0.040).margin(0.001));
  CHECK(axes[2] == Approx(0.032).margin(0.001));
  const auto drawn =
      fuse::fit_silhouettes({outline}, Ellipsoid(Sphere{body.center, 0.036}), SizePrior{0.04, 1e-4}, 0.3);
  REQUIRE(drawn);
  CHECK(drawn->body.mean_radius() > fit->body.mean_radius() + 0.002);
}

TEST_CASE("a tight prior makes a ball of an outline") {
  const auto fit = fuse::fit_silhouettes({outline_of_egg()}, egg(), std::nullopt, 0.001);
  REQUIRE(fit);
  const Eigen::Vector3d axes = semi_axes(fit->body).first;
  CHECK(axes[0] - axes[2] < 0.001);
}

TEST_CASE("rays without weight do not count") {
  const fuse::Silhouette outline = outline_of_egg();
  fuse::Silhouette with_others = outline;
  for (std::size_t i = 0; i < 40; ++i) {  // a tenth of the way inwards
    with_others.rays.push_back((9.0 * outline.rays[i] + egg().center.normalized()).normalized());
    with_others.weights.push_back(0.0);
  }
  const Ellipsoid start(Sphere{egg().center, 0.036});
  const auto fit = fuse::fit_silhouettes({outline}, start, std::nullopt, 0.3);
  const auto same = fuse::fit_silhouettes({with_others}, start, std::nullopt, 0.3);
  REQUIRE(fit);
  REQUIRE(same);
  CHECK((same->body.center - fit->body.center).norm() < 1e-12);
  CHECK((same->body.A - fit->body.A).norm() < 1e-9);
  CHECK(same->inliers == fit->inliers);
}

TEST_CASE("the exact outline and front of a ball give that ball") {
  fuse::Silhouette outline = outline_of_ball(kBall, kSensor);
  outline.front = {kNearest};
  const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(Sphere{{0.101, 0.199, 0.702}, 0.041}), std::nullopt);
  REQUIRE(fit);
  CHECK((fit->body.center - kBall.center).norm() < 1e-5);
  CHECK((semi_axes(fit->body).first - Eigen::Vector3d::Constant(kBall.radius)).norm() < 1e-5);
  CHECK(fit->inliers == 90);
  CHECK(fit->rms < 1e-5);
}

TEST_CASE("the rms is of how far the rays pass from the surface") {
  // A ray at the angle a from the center passes it at distance * sin(a): by cos(a) times the turn farther or nearer.
  for (const double turned : {0.0002, 0.0005}) {
    fuse::Silhouette outline = outline_of_ball(kBall, kSensor, turned);
    outline.front = {kNearest};
    const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(kBall), std::nullopt, kRigid);
    REQUIRE(fit);
    CHECK(fit->rms == Approx(turned * std::sqrt(1.0 - 0.04 * 0.04)).epsilon(0.01));
    CHECK((fit->body.center - kBall.center).norm() < 1e-4);
  }
}

TEST_CASE("rays farther off than three standard deviations do not count") {
  fuse::Silhouette outline = outline_of_ball(kBall, kSensor);
  outline.front = {kNearest};
  const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(kBall), std::nullopt);
  REQUIRE(fit);
  for (const double off : {-0.0062, 0.0062}) {  // rad; 0.002 is the standard deviation
    fuse::Silhouette more = outline;
    const double angle = std::asin(0.04) + off;
    more.rays.emplace_back(std::sin(angle), 0.0, std::cos(angle));
    more.weights.push_back(1.0);
    const auto other = fuse::fit_silhouettes({more}, Ellipsoid(kBall), std::nullopt);
    REQUIRE(other);
    CHECK(same(*other, *fit));
    more.rays.back() = {std::sin(angle - 0.1 * off), 0.0, std::cos(angle - 0.1 * off)};
    CHECK(fuse::fit_silhouettes({more}, Ellipsoid(kBall), std::nullopt)->inliers == 91);
  }
}

TEST_CASE("an outline without rays changes nothing") {
  const fuse::Silhouette outline = outline_of_ball(kBall, kSensor, 0.0005);
  const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(kBall), SizePrior{0.04, 0.1});
  const auto both = fuse::fit_silhouettes({outline, {}}, Ellipsoid(kBall), SizePrior{0.04, 0.1});
  REQUIRE(fit);
  REQUIRE(both);
  CHECK(same(*both, *fit));
}

TEST_CASE("fewer than three rays fit no body, no outline is refused") {
  fuse::Silhouette outline = outline_of_ball(kBall, kSensor);
  outline.front = {kNearest};
  outline.rays = {outline.rays[0], outline.rays[30], outline.rays[60]};
  outline.weights = {1.0, 1.0, 1.0};
  CHECK(fuse::fit_silhouettes({outline}, Ellipsoid(kBall), std::nullopt));
  outline.weights[1] = 0.0;
  CHECK_FALSE(fuse::fit_silhouettes({outline}, Ellipsoid(kBall), std::nullopt));
  CHECK_THROWS_AS(fuse::fit_silhouettes({}, Ellipsoid(kBall), std::nullopt), InputError);
}

TEST_CASE("the rays of an outline count as sixteen, fewer where it is hidden") {
  // Aside a ray measures with the cosine of its turn; the mean of its square is 1/2. Along z the front measures the
  // center less the radius, and the rays the radius less 1/25 of the center.
  constexpr double kRay = 0.002, kFront = 0.004, kSine = 0.04;
  const auto check = [&](const std::vector<fuse::Silhouette>& outlines, double rays, double fronts) {
    const auto fit = fuse::fit_silhouettes(outlines, Ellipsoid(kBall), std::nullopt, kRigid);
    REQUIRE(fit);
    const double aside = kRay * kRay / (0.5 * rays * (1.0 - kSine * kSine));
    CHECK(fit->center_covariance(0, 0) == Approx(aside).epsilon(0.01));
    CHECK(fit->center_covariance(1, 1) == Approx(aside).epsilon(0.01));
    const double ray = kRay * kRay / rays, front = kFront * kFront / fronts, less = std::pow(1.0 - kSine, 2);
    CHECK(fit->center_covariance(2, 2) == Approx((front + ray) / less).epsilon(0.01));
    const double radius = (ray + kSine * kSine * front) / less;
    CHECK(fit->shape_covariance(0, 0) == Approx(radius / std::pow(kBall.radius, 4)).epsilon(0.01));
    CHECK(fit->inliers == 90 * outlines.size());
  };
  fuse::Silhouette outline = outline_of_ball(kBall, kSensor);
  outline.front = {kNearest};
  check({outline}, 16.0, 1.0);
  check({outline, outline}, 32.0, 2.0);
  outline.front.assign(50, kNearest);  // of the front only the mean counts
  check({outline}, 16.0, 1.0);
  outline.seen = 0.25;
  check({outline}, 4.0, 1.0);
  outline.seen = 1.0;
  for (std::size_t i = 0; i < 90; ++i) outline.weights[i] = 0.1;  // nine rays
  check({outline}, 9.0, 1.0);
}

TEST_CASE("the front counts where it faces the sensor") {
  fuse::Silhouette outline = outline_of_ball(kBall, kSensor);
  outline.front = {kNearest};
  const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(kBall), std::nullopt, kRigid);
  REQUIRE(fit);
  const auto add = [&](double turn, double outwards) {  // rad from the nearest point
    fuse::Silhouette more = outline;
    for (const double side : {-1.0, 1.0})
      more.front.push_back(kBall.center +
                           (kBall.radius + outwards) * Eigen::Vector3d(side * std::sin(turn), 0.0, -std::cos(turn)));
    return fuse::fit_silhouettes({more}, Ellipsoid(kBall), std::nullopt, kRigid);
  };
  CHECK(same(*add(deg(50.0), 0.003), *fit));  // at 45.6 degrees the cosine is 0.7, seen from far away
  CHECK(same(*add(deg(130.0), 0.003), *fit));
  CHECK(same(*add(0.0, 0.017), *fit));  // farther off than four standard deviations
  CHECK_FALSE(same(*add(0.0, 0.015), *fit));
  const auto nearer = add(0.0, 0.003);
  REQUIRE(nearer);
  // Three points, two of them 3 mm nearer: the front is 2 mm nearer, where the ball is a little smaller.
  CHECK(nearer->body.center.z() - nearer->body.mean_radius() == Approx(0.658).margin(0.0002));
  CHECK(nearer->body.center.z() < kBall.center.z() - 0.0015);
  CHECK(add(deg(40.0), 0.003)->body.center.z() < kBall.center.z() - 0.0015);
}

TEST_CASE("of points before the gate nothing counts, whatever memory held before") {
  fuse::Silhouette front, leaf;  // the derivatives of the leaf's rows are not computed
  const fuse::Silhouette outline = outline_of_ball(kBall, kSensor);
  front.sensor = leaf.sensor = kSensor;
  front.front = leaf.front = {kNearest};
  leaf.front.insert(leaf.front.begin(), kNearest - Eigen::Vector3d(0.0, 0.0, 0.03));
  const auto fit = fuse::fit_silhouettes({front, outline}, Ellipsoid(kBall), std::nullopt, kRigid);
  fill_stack();
  const auto with_leaf = fuse::fit_silhouettes({leaf, outline}, Ellipsoid(kBall), std::nullopt, kRigid);
  REQUIRE(fit);
  REQUIRE(with_leaf);
  CHECK(same(*with_leaf, *fit));
}

TEST_CASE("without a front the expected radius says how far away a body is") {
  const Eigen::Vector3d sensor(0.1, 0.2, -0.3);
  const Sphere ball{{0.1, 0.2, -0.2}, 0.04};  // so near that it fills a cone with a sine of 0.4
  fuse::Silhouette outline = outline_of_ball(ball, sensor);
  outline.angle_error = 0.02;
  for (const double start : {0.03, 0.04, 0.05}) {
    const Sphere first{sensor + Eigen::Vector3d(0.0, 0.0, start / 0.4), start};
    const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(first), SizePrior{0.04, 0.05}, kRigid);
    REQUIRE(fit);
    CHECK((fit->body.center - ball.center).norm() < 1e-4);
    CHECK(fit->body.mean_radius() == Approx(0.04).epsilon(0.001));
    // Standard deviations of the radius: 5 % of 0.04 m as expected, and 0.002 m / 4 by the rays.
    const double expected = 0.002 * 0.002, rays = 0.0005 * 0.0005;
    CHECK(fit->center_covariance(2, 2) == Approx((expected + rays) / (0.4 * 0.4)).epsilon(0.02));
    CHECK(fit->shape_covariance(2, 2) == Approx(expected / std::pow(0.04, 4)).epsilon(0.02));
  }
  // A front that says 0.04 m, and an expected radius of 0.042 m that is as sure.
  outline.front = {sensor + Eigen::Vector3d(0.0, 0.0, 0.06)};
  const double by_front = std::sqrt(0.0005 * 0.0005 + 0.4 * 0.4 * 0.0004 * 0.0004) / (1.0 - 0.4);
  const auto fit = fuse::fit_silhouettes({outline}, Ellipsoid(ball), SizePrior{0.042, by_front / 0.042}, kRigid);
  REQUIRE(fit);
  CHECK(fit->body.mean_radius() == Approx(0.041).margin(0.00015));
}

}  // namespace silhouette_test
