// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/silhouette.hpp>

#include "catch.hpp"

using namespace agrisee;

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
      fuse::fit_silhouettes({outline}, Ellipsoid(Sphere{body.center, 0.036}), fuse::ExpectedRadius{0.04, 1e-4}, 0.3);
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
