// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/last_fits.hpp>
#include <agrisee/geometry/spiral.hpp>

#include <random>

#include "catch.hpp"

namespace last_fits_test {

using namespace agrisee;

constexpr double kRadius = 0.011;               // of a cherry (m)
const Eigen::Vector3d kCenter(0.02, 0.5, 0.3);  // of it (m)

/// Three quarters of a cherry's surface, all but its back (+y), with noise.
Cloud cherry(double noise) {
  constexpr int kPoints = 160;
  std::mt19937 random(3);
  std::normal_distribution<double> error(0.0, noise);
  Cloud cloud;
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d u = spiral_direction(i, kPoints);
    if (u.y() > 0.5) continue;
    cloud.points.push_back((kCenter + (kRadius + error(random)) * u).cast<float>());
    cloud.normals.push_back(u.cast<float>());
  }
  return cloud;
}

/// Adds points where the cherry runs into what touches it from behind: outside of it, their normals turned to the side.
void touch_from_behind(Cloud& cloud) {
  for (int i = 0; i < 24; ++i) {
    const double around = 0.05 * (i % 8), outside = 0.0008 + 0.0009 * (i / 8);
    const Eigen::Vector3d u = Eigen::Vector3d(std::cos(around), 0.45 + 0.1 * (i / 8), std::sin(around)).normalized();
    const Eigen::Vector3d turned = (u + 0.75 * Eigen::Vector3d(1.0, -1.0, 0.0).normalized()).normalized();
    cloud.points.push_back((kCenter + (kRadius + outside) * u).cast<float>());
    cloud.normals.push_back(turned.cast<float>());
  }
}

/// A body about the cherry, as it is fitted to all points.
FoundBody found_in(const Cloud& cloud) {
  const Labels all(cloud.size(), 1);
  FoundBody body;
  body.fit = *fit_ellipsoid(cloud, indices_by_label(all)[0], Ellipsoid(Sphere{kCenter, kRadius}));
  return body;
}

TEST_CASE("points between a small fruit and what touches it do not pull its last fit") {
  for (const double noise : {0.0, 0.0001, 0.0002}) {
    INFO("noise " << noise);
    Cloud cloud = cherry(noise);
    touch_from_behind(cloud);
    std::vector<FoundBody> found = {found_in(cloud)};
    const double before = (found[0].fit.body.center - kCenter).norm();
    CHECK(before > 0.0005);
    fit_closely(cloud, Labels(cloud.size(), 1), BodyParameters(), found);
    CHECK((found[0].fit.body.center - kCenter).norm() < 0.4 * before);
    CHECK(found[0].fit.body.mean_radius() == Approx(kRadius).margin(0.0002));
  }
}

TEST_CASE("points that scatter as widely as expected all count in the last fit") {
  const Cloud cloud = cherry(0.0006);
  std::vector<FoundBody> found = {found_in(cloud)};
  const Ellipsoid before = found[0].fit.body;
  fit_closely(cloud, Labels(cloud.size(), 1), BodyParameters(), found);
  CHECK((found[0].fit.body.center - before.center).norm() < 1e-4);
  CHECK((found[0].fit.body.A - before.A).norm() < 0.01 * before.A.norm());
}

TEST_CASE("from the usual radius on the last fit is not closer, and between small and usual in part") {
  Cloud cloud = cherry(0.0001);
  touch_from_behind(cloud);
  const FoundBody before = found_in(cloud);
  const auto error = [&](double usual_radius) {
    BodyParameters parameters;
    parameters.usual_radius = usual_radius;
    std::vector<FoundBody> found = {before};
    fit_closely(cloud, Labels(cloud.size(), 1), parameters, found);
    return (found[0].fit.body.center - kCenter).norm();
  };
  CHECK(error(0.9 * kRadius) == (before.fit.body.center - kCenter).norm());
  CHECK(error(1.25 * kRadius) < error(0.9 * kRadius));
  CHECK(error(2.0 * kRadius) < error(1.25 * kRadius));
}

TEST_CASE("bodies by masks, with a size prior, or without points keep their fit") {
  Cloud cloud = cherry(0.0001);
  touch_from_behind(cloud);
  std::vector<FoundBody> found(3, found_in(cloud));
  const Ellipsoid before = found[0].fit.body;
  const auto fit = [&](int label) {
    fit_closely(cloud, Labels(cloud.size(), label), BodyParameters(), found);
    return found[static_cast<std::size_t>(label) - 1].fit.body.center;
  };
  found[0].by_mask = true;
  found[1].fit.size_prior = SizePrior{kRadius, 0.1};
  CHECK(fit(1) == before.center);
  CHECK(fit(2) == before.center);
  CHECK(found[2].fit.body.center == before.center);
  CHECK(fit(3) != before.center);
}

}  // namespace last_fits_test
