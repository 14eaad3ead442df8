// SPDX-License-Identifier: BSD-3-Clause
// Distances to solid ellipsoids, against brute force over their surfaces.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/ellipsoid.hpp>

#include "catch.hpp"

using namespace agrisee;
using Eigen::Vector3d;

namespace {

OrientedEllipsoid some_ellipsoid(Rng& rng) {
  OrientedEllipsoid e;
  e.center = {rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)};
  e.radii = {rng.uniform(0.01, 0.06), rng.uniform(0.01, 0.06), rng.uniform(0.01, 0.06)};
  e.axes = Eigen::AngleAxisd(rng.uniform(0, kPi), rng.direction()).toRotationMatrix();
  return e;
}

/// Distance from p to the nearest of many points of the surface.
double by_samples(const OrientedEllipsoid& e, const Vector3d& p) {
  double best = 1e9;
  for (int i = 0; i < 20000; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 20000, s = std::sqrt(1.0 - z * z), a = 2.399963229728653 * i;
    best = std::min(
        best, (e.center + e.axes * e.radii.cwiseProduct(Vector3d(s * std::cos(a), s * std::sin(a), z)) - p).norm());
  }
  return best;
}

}  // namespace

TEST_CASE("ellipsoid: the nearest point is on the surface, along its normal, and no sample is nearer") {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const OrientedEllipsoid e = some_ellipsoid(rng);
    const Vector3d p = e.center + rng.uniform(0.0, 0.15) * rng.direction();
    const Vector3d nearest = nearest_point(e, p);
    if (contains(e, p)) {
      CHECK(nearest == p);
      CHECK(distance(e, p) == 0.0);
      continue;
    }
    const Vector3d local = (e.axes.transpose() * (nearest - e.center)).cwiseQuotient(e.radii);
    CHECK(local.norm() == Approx(1.0).margin(1e-9));
    const Vector3d normal = (e.axes * local.cwiseQuotient(e.radii)).normalized();
    CHECK((p - nearest).cross(normal).norm() < 1e-8);
    CHECK(support(e, normal) == Approx(normal.dot(nearest)).margin(1e-9));
    if (i % 20) continue;
    const double samples = by_samples(e, p);
    CHECK(distance(e, p) <= samples + 1e-12);
    CHECK(distance(e, p) >= samples - 0.0015);
  }
}

TEST_CASE("ellipsoid: distance to a segment is that of its nearest point") {
  Rng rng(2);
  for (int i = 0; i < 200; ++i) {
    const OrientedEllipsoid e = some_ellipsoid(rng);
    const Vector3d a = 0.2 * rng.direction(), b = i % 10 ? Vector3d(0.2 * rng.direction()) : a;
    double best = 1e9;
    for (int k = 0; k <= 2000; ++k) best = std::min(best, distance(e, Vector3d(a + k / 2000.0 * (b - a))));
    CHECK(distance(e, a, b) <= best + 1e-7);
    CHECK(distance(e, a, b) >= best - 2e-4);
  }
}

TEST_CASE("ellipsoid: overlaps of capsules and cylinders as for a sphere") {
  Rng rng(3);
  int both[2] = {0, 0};
  for (int i = 0; i < 2000; ++i) {
    const double r = rng.uniform(0.01, 0.05);
    const OrientedEllipsoid sphere{0.1 * rng.direction(), Vector3d::Constant(r), Eigen::Matrix3d::Identity()};
    const Capsule capsule{0.1 * rng.direction(), 0.1 * rng.direction(), rng.uniform(0.005, 0.05)};
    const bool hit = segment_distance(capsule.a, capsule.b, sphere.center, sphere.center) < r + capsule.radius - kTouch;
    CHECK(overlap(capsule, sphere) == hit);
    const OrientedCylinder cylinder{0.1 * rng.direction(), rng.direction(), rng.uniform(0.01, 0.05), 0.06};
    const double apart = (nearest_point(cylinder, sphere.center) - sphere.center).norm();
    if (std::abs(apart - r) > 1e-4) CHECK(overlap(cylinder, sphere) == (apart < r));
    ++both[hit];
  }
  CHECK(both[0] > 200);
  CHECK(both[1] > 200);
}
