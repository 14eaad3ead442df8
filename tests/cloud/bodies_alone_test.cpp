// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/bodies_alone.hpp>

#include "catch.hpp"

namespace bodies_alone_test {

using namespace agrisee;
using namespace agrisee::detail;

constexpr double kSmall = 0.011;  // m

/// A body at a place along x.
FoundBody at(double x, double radius, double confidence) {
  FoundBody body;
  body.fit.body = Ellipsoid(Sphere{Eigen::Vector3d(x, 0.5, 0.3), radius});
  body.confidence = confidence;
  return body;
}

/// Parameters of a scan of several views whose normals have this noise (rad).
BodyParameters of_scan(double normal_noise) {
  BodyParameters parameters;
  parameters.alike = 0.0;
  parameters.normal_noise = normal_noise;
  return parameters;
}

/// What becomes of the confidence of the first body.
double left(std::vector<FoundBody> found, const BodyParameters& parameters) {
  doubt_bodies_alone(parameters, found);
  return found.at(0).confidence;
}

/// What it becomes when its log-odds fall.
double less(double confidence, double by) { return from_log_odds(log_odds(confidence) - by); }

TEST_CASE("at much noise, a small body that hangs alone is less likely a fruit") {
  const BodyParameters noisy = of_scan(0.15);
  CHECK(left({at(0.0, kSmall, 0.9)}, noisy) == Approx(less(0.9, 1.5)));
  CHECK(left({at(0.0, kSmall, 0.9)}, of_scan(0.4)) == Approx(less(0.9, 1.5)));
  CHECK(left({at(0.0, kSmall, 0.9)}, of_scan(0.05)) == Approx(less(0.9, 0.5)));
  CHECK(left({at(0.0, kSmall, 0.7)}, of_scan(0.0)) == 0.7);
  CHECK(left({at(0.0, noisy.usual_radius / 1.5, 0.7)}, noisy) == Approx(less(0.7, 0.75)));
  CHECK(left({at(0.0, noisy.usual_radius, 0.7)}, noisy) == 0.7);
  BodyParameters few_views = noisy;
  few_views.alike = 0.7;
  CHECK(left({at(0.0, kSmall, 0.7)}, few_views) == 0.7);
}

TEST_CASE("a small body near a likely fruit does not hang alone, also if both are small") {
  const BodyParameters noisy = of_scan(0.15);
  const auto beside = [&](double gap, double radius, double confidence) {
    return left({at(0.0, kSmall, 0.7), at(kSmall * (1.0 + gap) + radius, radius, confidence)}, noisy);
  };
  CHECK(beside(0.4, 0.03, 0.95) == 0.7);
  CHECK(beside(0.4, kSmall, 0.7) == 0.7);
  CHECK(beside(0.4, 0.03, 0.45) == Approx(less(0.7, 1.5)));
  CHECK(beside(0.75, 0.03, 0.95) == Approx(less(0.7, 0.75)));
  CHECK(beside(1.1, 0.03, 0.95) == Approx(less(0.7, 1.5)));
}

TEST_CASE("a body that a mask shows may hang alone") {
  FoundBody body = at(0.0, kSmall, 0.7), supported = body;
  body.by_mask = true;
  supported.prior = 0.4;
  CHECK(left({body}, of_scan(0.15)) == 0.7);
  CHECK(left({supported}, of_scan(0.15)) == 0.7);
}

}  // namespace bodies_alone_test
