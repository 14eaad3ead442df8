// SPDX-License-Identifier: BSD-3-Clause
// Volumes and masses of fitted fruit: by hand, and their standard errors against the scatter of repeated fits.
#include <agrisee/cloud/volume.hpp>

#include "catch.hpp"
#include "cloud/cloud_cases.hpp"
#include "spheres.hpp"

using namespace agrisee;
using cases::all_of;

TEST_CASE("volume and mass of an ellipsoid by hand") {
  Ellipsoid e;
  const Eigen::Matrix3d r = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  e.A = r * Eigen::Vector3d(1 / 0.04, 1 / 0.035, 1 / 0.03).asDiagonal() * r.transpose();
  CHECK(volume(e) == Approx(4.0 / 3.0 * kPi * 0.04 * 0.035 * 0.03));
  MassParameters p;
  p.density = 1000.0;
  p.density_error = 30.0;
  p.shape_error = 0.03;
  const Estimate v = volume_of(e, 0.04, p), m = mass_of(v, p);
  CHECK(v.error == Approx(0.05 * v.value));
  CHECK(m.value == Approx(1000.0 * v.value));
  CHECK(m.error == Approx(std::hypot(0.05, 0.03) * m.value));
  for (const double bad : {0.0, 99.0, 5001.0}) {
    p.density = bad;
    CHECK_THROWS_AS(p.check(), ParameterError);
  }
  p.density = 0.98;
  CHECK_THROWS_WITH(p.check(),
                    "density must be from 100 to 5000, got 0.98: densities are in kg/m3; 0.98 g/cm3 are 980");
}

TEST_CASE("the standard error of a volume is the scatter of repeated fits") {
  FitParameters parameters;
  parameters.noise = 0.001;
  for (const double lowest : {-1.1, 0.0}) {  // the whole sphere, half of it
    double squares = 0.0, expected = 0.0;
    constexpr int kTrials = 100;
    // So few points that the fit takes their errors as independent, as here they are.
    for (int trial = 0; trial < kTrials; ++trial) {
      Cloud cloud;
      test::add_sphere(
          cloud, {{0.1, 0.5, 0.2}, 0.035}, 0.011, [&](const Eigen::Vector3d& d) { return d.y() > lowest; }, 0.001,
          static_cast<std::uint64_t>(trial + 1));
      // The fit's prior on the shape holds here exactly, as it would for a population of fruit: make it tight.
      parameters.shape_prior = 0.001;
      const auto fit = fit_ellipsoid(cloud, all_of(cloud), Ellipsoid(Sphere{{0.102, 0.5, 0.2}, 0.034}), parameters);
      REQUIRE(fit);
      squares += std::pow(volume(fit->body) / (4.0 / 3.0 * kPi * std::pow(0.035, 3)) - 1.0, 2);
      expected += relative_volume_error(cloud, all_of(cloud), fit->body, parameters).total;
    }
    const double scatter = std::sqrt(squares / kTrials), estimated = expected / kTrials;
    INFO("scatter " << scatter << ", estimated " << estimated);
    CHECK(estimated > 0.7 * scatter);
    CHECK(estimated < 1.5 * scatter);
  }
}

TEST_CASE("the standard error of a volume rests on the larger of the two noises") {
  // A sphere that is seen from all sides: the error of its volume is three times that of its radius.
  const double radius = GENERATE(0.01, 0.03), sensor_noise = GENERATE(0.0, 0.0003, 0.003);
  FitParameters parameters;
  parameters.sensor_noise = sensor_noise;
  parameters.shape_prior = 1e-4;
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0, 0}, radius}, 0.1 * radius, test::everywhere);
  const double error =
      relative_volume_error(cloud, all_of(cloud), Ellipsoid(Sphere{{0, 0, 0}, radius}), parameters).total;
  const double points = std::min({static_cast<double>(cloud.size()), static_cast<double>(parameters.independent)});
  CHECK(error == Approx(3.0 * std::max(parameters.noise, sensor_noise) / radius / std::sqrt(points)).epsilon(0.05));
}

TEST_CASE("the less is seen, the less a volume is known") {
  double last = 0.0;
  for (const double lowest : {-1.1, 0.0, 0.4, 0.8}) {
    Cloud cloud;
    test::add_sphere(cloud, {{0, 0, 0}, 0.035}, 0.002, [&](const Eigen::Vector3d& d) { return d.y() > lowest; });
    const VolumeError error = relative_volume_error(cloud, all_of(cloud), Ellipsoid(Sphere{{0, 0, 0}, 0.035}));
    CHECK(error.total > last);
    CHECK(error.by_shape < error.total);
    CHECK((lowest < -1.0 ? error.by_shape < 0.1 * error.total : error.by_shape > 0.1 * error.total));
    last = error.total;
  }
  CHECK(relative_volume_error(Cloud{}, {}, Ellipsoid(Sphere{{0, 0, 0}, 0.035})).total == 1.0);
}

TEST_CASE("a volume without points that agree with its body is not known at all, parameters are checked") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0, 0}, 0.035}, 0.01, test::everywhere);
  CHECK(relative_volume_error(cloud, all_of(cloud), Ellipsoid(Sphere{{0.2, 0, 0}, 0.035})).total == 1.0);
  FitParameters parameters;
  parameters.noise = 0.0;
  CHECK_THROWS_AS(relative_volume_error(cloud, all_of(cloud), Ellipsoid(Sphere{{0, 0, 0}, 0.035}), parameters),
                  ParameterError);
}
