// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/body_verdict.hpp>

#include <numeric>
#include <optional>
#include <random>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::detail;

namespace {

constexpr double kRadius = 0.03;

/// Points of a sphere about the origin within an angle of the direction -y, from where a camera might look.
Cloud cap(double angle, double noise = 0.0) {
  Cloud cloud;
  std::mt19937 random(1);
  std::normal_distribution<double> error(0.0, 1.0);
  const double golden = kPi * (3.0 - std::sqrt(5.0));
  constexpr int kAll = 2000;
  for (int i = 0; i < kAll; ++i) {
    const double y = 1.0 - 2.0 * (i + 0.5) / kAll, across = std::sqrt(1.0 - y * y);
    const Eigen::Vector3d d(across * std::cos(golden * i), y, across * std::sin(golden * i));
    if (-d.y() < std::cos(angle)) continue;
    const Eigen::Vector3d tilt(error(random), error(random), error(random));
    cloud.points.push_back(((kRadius + 0.02 * noise * error(random)) * d).cast<float>());
    cloud.normals.push_back((d + noise * tilt).normalized().cast<float>());
  }
  return cloud;
}

EllipsoidFit fit_of(double rms) {
  EllipsoidFit fit;
  fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), kRadius});
  fit.rms = rms;
  return fit;
}

Verdict verdict_of(const Cloud& cloud, const SeenThrough& through = {}) {
  const Grid<float> grid(cloud, 0.006f);
  return judge(cloud, grid, std::vector<char>(cloud.size(), 0), fit_of(0.0).body, BodyParameters(), through);
}

}  // namespace

TEST_CASE("a verdict measures what it says, on half a sphere") {
  const Cloud cloud = cap(kPi / 2);
  const Verdict v = verdict_of(cloud);
  CHECK(v.support == cloud.size());
  CHECK(v.coverage == Approx(0.5).margin(0.06));
  CHECK(v.roundness > 0.95);
  CHECK(v.normal_spread < 1e-3);
  CHECK(v.clutter == 0.0);
  CHECK(v.inside == 0.0);
}

TEST_CASE("the normals of few points on a ball do not spread") {
  const Verdict v = verdict_of(cap(deg(20)));
  CHECK(v.support < 100);
  CHECK(v.normal_spread < 1e-3);
}

TEST_CASE("normals that differ, and points nearby that do not fit, are counted") {
  Cloud cloud = cap(kPi / 2, 0.2);
  CHECK(verdict_of(cloud).normal_spread == Approx(std::sin(std::atan(0.2 * std::sqrt(2.0)))).margin(0.05));
  cloud = cap(kPi / 2);
  const std::size_t own = cloud.size();
  for (std::size_t i = 0; i < own / 2; ++i) {  // a leaf 6 mm above the surface
    cloud.points.push_back(cloud.points[i] * 1.2f);
    cloud.normals.push_back(cloud.normals[i]);
  }
  CHECK(verdict_of(cloud).clutter == Approx(0.5).margin(0.01));
}

TEST_CASE("points all around a fruit are round, those of the end of a post are not") {
  CHECK(verdict_of(cap(kPi)).roundness > 0.95);
  Cloud post;  // upright, cut off 0.8 radii above its middle, as by the border of the scan volume
  for (int i = 0; i < 2000; ++i) {
    const double angle = 2.4 * i, z = kRadius * (0.8 - 1.6 * (i + 0.5) / 2000);
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0.0);
    post.points.push_back((0.95 * kRadius * out + z * Eigen::Vector3d::UnitZ()).cast<float>());
    post.normals.push_back(out.cast<float>());
  }
  const Verdict v = verdict_of(post);
  CHECK(v.coverage > 0.4);  // so that of all evidence its curvature alone speaks against it
  CHECK(v.roundness < BodyParameters().min_roundness);
}

TEST_CASE("in a single view the curvatures of a patch decide alone") {
  const Cloud half = cap(kPi / 2);
  const Ellipsoid body = fit_of(0.0).body;
  Indices near(half.size());
  std::iota(near.begin(), near.end(), Index{0});
  const std::vector<char> free(half.size(), 0);
  Cloud deep = half;  // its sides reach farther back than a ball's
  for (Eigen::Vector3f& n : deep.normals) n.y() *= 0.1f, n.normalize();
  CHECK(judge_quickly(deep, near, free, body, BodyParameters(), true).roundness > 0.9);
  CHECK(judge_quickly(deep, near, free, body, BodyParameters(), false).roundness < 0.5);
}

TEST_CASE("fewer points on a smaller body count as much in several views, but not in a single one") {
  Verdict v = verdict_of(cap(kPi / 2));
  const double usual = 0.42 * BodyParameters().radius_max;
  const auto believed = [&](double radius, std::size_t support, std::optional<double> seen_on) {
    EllipsoidFit fit;
    fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), radius});
    v.support = support;
    v.seen_on = seen_on;
    const double p = fruit_probability(v, fit, BodyParameters());
    return std::log(p / (1.0 - p)) -
           1.7 * std::min(radius / BodyParameters().radius_max, 0.5);  // without the size itself
  };
  CHECK(believed(0.5 * usual, 50, {}) == Approx(believed(usual, 200, {})));
  CHECK(believed(0.5 * usual, 50, 1.0) < believed(usual, 200, 1.0) - 1.0);
  CHECK(believed(2.0 * usual, 200, {}) == Approx(believed(usual, 200, {})));
}

TEST_CASE("whatever speaks against a fruit lowers its probability") {
  const Verdict good = verdict_of(cap(kPi / 2));
  const double believed = fruit_probability(good, fit_of(0.0005), BodyParameters());
  CHECK(believed > 0.95);
  CHECK(fruit_probability(good, fit_of(0.002), BodyParameters()) < believed);
  const auto with = [&](auto&& change) {
    Verdict v = good;
    change(v);
    return fruit_probability(v, fit_of(0.0005), BodyParameters());
  };
  CHECK(with([](Verdict& v) { v.normal_spread = 0.4; }) < believed);
  CHECK(with([](Verdict& v) { v.clutter = 3.0; }) < believed);
  CHECK(with([](Verdict& v) { v.normal_spread = 0.4, v.clutter = 3.0, v.support = 60; }) < 0.05);  // a tuft of leaves
  CHECK(with([](Verdict& v) { v.inside = 0.1; }) < believed);
  CHECK(with([](Verdict& v) { v.seen_through = 0.1; }) < believed);
  CHECK(with([](Verdict& v) { v.seen_on = 0.5; }) < with([](Verdict& v) { v.seen_on = 1.0; }));
  CHECK(with([](Verdict& v) { v.roundness = 0.35; }) < believed);
  CHECK(with([](Verdict& v) { v.support = 20; }) < believed);
  CHECK(fruit_probability(Verdict(), fit_of(0.0), BodyParameters()) == 0.0);
}

TEST_CASE("several views show that a stump is no fruit, a single view hardly does") {
  const auto odds = [](double roundness, std::optional<double> seen_on) {
    Verdict v = verdict_of(cap(kPi / 2));
    v.roundness = roundness;
    v.seen_on = seen_on;
    const double p = fruit_probability(v, fit_of(0.0005), BodyParameters());
    return std::log(p / (1.0 - p));
  };
  CHECK(odds(0.7, {}) - odds(0.6, {}) == Approx(odds(0.7, 1.0) - odds(0.6, 1.0)));
  CHECK(odds(0.5, {}) - odds(0.4, {}) > 3.0 * (odds(0.5, 1.0) - odds(0.4, 1.0)));
}

TEST_CASE("a body larger than fruit are expected to be is less likely one") {
  const EllipsoidFit fit = fit_of(0.0005);
  const Verdict v = verdict_of(cap(kPi / 2));
  BodyParameters parameters;
  const auto odds = [&](double share_of_radius) {
    parameters.radius_max = fit.body.mean_semi_axis() / share_of_radius;
    const double p = fruit_probability(v, fit, parameters);
    return std::log(p / (1.0 - p));
  };
  CHECK(odds(1.0) == Approx(odds(0.99)));
  CHECK(odds(1.1) < odds(1.0) - 2.0);
}

TEST_CASE("in several views noise speaks for a body, the more so the smaller it is") {
  Verdict v = verdict_of(cap(kPi / 2));
  v.normal_spread = 0.0;
  const auto gain = [&](double radius, std::optional<double> seen_on) {
    EllipsoidFit fit;
    fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), radius});
    v.seen_on = seen_on;
    const auto odds = [&](double noise) {
      BodyParameters parameters;
      parameters.normal_noise = noise;
      const double p = fruit_probability(v, fit, parameters);
      return std::log(p / (1.0 - p));
    };
    return odds(0.1) - odds(0.0);
  };
  CHECK(gain(0.010, {}) > 0.2);
  CHECK(gain(0.030, {}) == Approx(gain(0.010, {}) / 3.0));
  CHECK(gain(0.010, 1.0) == Approx(0.0).margin(1e-9));
}

TEST_CASE("the spread of normals that the sensor accounts for does not speak against a fruit") {
  Verdict v = verdict_of(cap(kPi / 2));
  v.normal_spread = 0.3;
  v.seen_on = 1.0;
  const EllipsoidFit fit = fit_of(0.0005);
  BodyParameters noisy;
  noisy.normal_noise = 0.2;
  const double believed = fruit_probability(v, fit, noisy);
  CHECK(believed > fruit_probability(v, fit, BodyParameters()));
  Verdict rest = v;
  rest.normal_spread = std::sqrt(0.3 * 0.3 - 0.2 * 0.2);  // variances are added
  CHECK(believed == Approx(fruit_probability(rest, fit, BodyParameters())));
  noisy.normal_noise = 0.5;  // more than there is
  rest.normal_spread = 0.0;
  CHECK(fruit_probability(v, fit, noisy) == Approx(fruit_probability(rest, fit, BodyParameters())));
}

TEST_CASE("where the sensor's errors are larger than the tolerance they widen it, up to a limit") {
  BodyParameters parameters;
  const double usual = parameters.near(0.035);
  CHECK(usual == Approx(0.08 * 0.035));
  parameters.fit.sensor_noise = 0.003;  // less than the tolerance admits
  CHECK(parameters.near(0.035) == usual);
  parameters.fit.sensor_noise = 0.006;
  CHECK(parameters.near(0.035) == Approx(0.0036));
  parameters.fit.sensor_noise = 0.1;
  CHECK(parameters.near(0.035) == Approx(0.12 * 0.035));
}
