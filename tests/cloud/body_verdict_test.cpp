// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/body_verdict.hpp>

#include <numeric>
#include <optional>
#include <random>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;
using namespace agrisee::detail;

namespace {

double exact_log_odds(double p) { return std::log(p / (1.0 - p)); }

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
  CHECK(verdict_of(cloud).turned == 0.0);
  for (std::size_t i = own; i < cloud.size(); ++i) {  // the same number of its own points, the normals of which are off
    cloud.points[i] = cloud.points[i - own];
    cloud.normals[i] = -cloud.normals[i];
  }
  CHECK(verdict_of(cloud).clutter == Approx(0.5).margin(0.01));
  CHECK(verdict_of(cloud).turned == verdict_of(cloud).clutter);
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
  CHECK(believed(0.6 * usual, 72, {}) == Approx(believed(usual, 200, {})));
  CHECK(believed(0.6 * usual, 72, 1.0) < believed(usual, 200, 1.0) - 1.0);
  CHECK(believed(2.0 * usual, 200, {}) == Approx(believed(usual, 200, {})));
}

TEST_CASE("of small bodies in several views roundness counts more, and spread normals count less") {
  const auto log_odds_of = [](double radius, double roundness, double spread, std::optional<double> seen_on = {}) {
    Verdict v = verdict_of(cap(kPi / 2));
    v.roundness = roundness;
    v.normal_spread = spread;
    v.seen_on = seen_on;
    EllipsoidFit fit;
    fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), radius});
    return log_odds(fruit_probability(v, fit, BodyParameters()));
  };
  const auto by_roundness = [&](double radius, std::optional<double> seen_on = {}) {
    return log_odds_of(radius, 0.75, 0.2, seen_on) - log_odds_of(radius, 0.55, 0.2, seen_on);
  };
  const auto by_spread = [&](double radius, std::optional<double> seen_on = {}) {
    return log_odds_of(radius, 0.6, 0.1, seen_on) - log_odds_of(radius, 0.6, 0.16, seen_on);
  };
  CHECK(by_roundness(0.010) > 2.0 * by_roundness(0.015));
  CHECK(by_spread(0.015) > 0.5);
  CHECK(by_spread(0.008) == Approx(0.0).margin(1e-9));  // patches explain it
  CHECK(by_roundness(0.010, 1.0) == Approx(by_roundness(0.015, 1.0)));
  CHECK(by_spread(0.010, 1.0) == Approx(by_spread(0.015, 1.0)));
}

TEST_CASE("at much noise, normals speak less against bodies in several views") {
  const auto log_odds_of = [](double radius, double noise, std::optional<double> seen_on, auto&& change) {
    Verdict v = verdict_of(cap(kPi / 2));
    v.roundness = 0.7;
    v.normal_spread = 0.3;
    v.seen_on = seen_on;
    change(v);
    EllipsoidFit fit;
    fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), radius});
    BodyParameters parameters;
    parameters.normal_noise = noise;
    return log_odds(fruit_probability(v, fit, parameters));
  };
  const auto by_spread = [&](double radius, double noise, std::optional<double> seen_on = {}) {
    return log_odds_of(radius, noise, seen_on, [](Verdict& v) { v.normal_spread = 0.0; }) -
           log_odds_of(radius, noise, seen_on, [](Verdict&) {});
  };
  CHECK(by_spread(0.012, 0.15) < by_spread(0.020, 0.15) - 0.1);  // the patches are wide against the body
  CHECK(by_spread(0.014, 0.0) == Approx(by_spread(0.020, 0.0)));
  CHECK(by_spread(0.012, 0.15, 1.0) == Approx(by_spread(0.020, 0.15, 1.0)));
  const auto by_clutter = [&](double turned, double noise, std::optional<double> seen_on = {}) {
    return log_odds_of(0.02, noise, seen_on, [&](Verdict& v) { v.clutter = 1.0, v.turned = turned; }) -
           log_odds_of(0.02, noise, seen_on, [](Verdict& v) { v.clutter = 1.0; });
  };
  CHECK(by_clutter(0.5, 0.0) == Approx(0.0).margin(1e-9));
  CHECK(by_clutter(0.5, 0.15) == Approx(2.32 * std::log(2.0 / 1.5)));
  CHECK(by_clutter(0.5, 0.3) == Approx(by_clutter(0.5, 0.15)));
  CHECK(by_clutter(0.5, 0.15, 1.0) == Approx(0.0).margin(1e-9));
}

TEST_CASE("in several views a body below the smallest expected radius is less likely a fruit") {
  const auto log_odds_of = [](double radius, double least, std::optional<double> seen_on = {}) {
    Verdict v = verdict_of(cap(kPi / 2));
    v.seen_on = seen_on;
    EllipsoidFit fit;
    fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), radius});
    BodyParameters parameters;
    parameters.radius_min = least;
    return log_odds(fruit_probability(v, fit, parameters));
  };
  CHECK(log_odds_of(0.0100, 0.010) == Approx(log_odds_of(0.0100, 0.008)));
  CHECK(log_odds_of(0.0100, 0.011) == Approx(log_odds_of(0.0100, 0.008) - 0.8));
  CHECK(log_odds_of(0.0100, 0.011, 1.0) == Approx(log_odds_of(0.0100, 0.008, 1.0)));
}

TEST_CASE("outside of the rim of a pot more of the surface goes on than outside of any fruit") {
  const auto log_odds_of = [](double beyond) {
    Verdict v = verdict_of(cap(kPi / 2));
    v.beyond = beyond;
    return log_odds(fruit_probability(v, fit_of(0.0005), BodyParameters()));
  };
  CHECK(log_odds_of(0.03) == Approx(log_odds_of(0.0) - 1.0));
  CHECK(log_odds_of(0.07) == Approx(log_odds_of(0.03)));
  CHECK(log_odds_of(0.09) == Approx(log_odds_of(0.07) - 2.0));
  CHECK(log_odds_of(0.2) == Approx(log_odds_of(0.07) - 3.0));
}

TEST_CASE("a small fruit is not less likely where only small ones are expected") {
  EllipsoidFit fit;
  fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), 0.01});
  fit.rms = 0.0005;
  BodyParameters wide, narrow;
  narrow.radius_max = 0.02;
  const Verdict v = verdict_of(cap(kPi / 2));
  CHECK(fruit_probability(v, fit, narrow) >= fruit_probability(v, fit, wide));
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

namespace {

/// Log-odds in favor of half a sphere with one of the evidences replaced, in several views or in a single one.
double odds_with(double Verdict::*evidence, double value, std::optional<double> seen_on) {
  Verdict v = verdict_of(cap(kPi / 2));
  v.*evidence = value;
  v.seen_on = seen_on;
  const double p = fruit_probability(v, fit_of(0.0005), BodyParameters());
  return std::log(p / (1.0 - p));
}

}  // namespace

TEST_CASE("several views show that a stump is no fruit, a single view hardly does") {
  const auto odds = [](double roundness, std::optional<double> seen_on) {
    return odds_with(&Verdict::roundness, roundness, seen_on);
  };
  CHECK(odds(0.7, {}) - odds(0.6, {}) == Approx(odds(0.7, 1.0) - odds(0.6, 1.0)));
  CHECK(odds(0.5, {}) - odds(0.4, {}) > 3.0 * (odds(0.5, 1.0) - odds(0.4, 1.0)));
}

TEST_CASE("several views show that a box is no fruit: normals spread more than those of any fruit") {
  const auto odds = [](double spread, std::optional<double> seen_on) {
    return odds_with(&Verdict::normal_spread, spread, seen_on);
  };
  CHECK(odds(0.2, {}) - odds(0.3, {}) == Approx(odds(0.2, 1.0) - odds(0.3, 1.0)));
  CHECK(odds(0.3, {}) - odds(0.4, {}) > 2.0 * (odds(0.3, 1.0) - odds(0.4, 1.0)));
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

TEST_CASE("of the misfit of a body, noise explains what variances leave, up to a limit") {
  BodyParameters noisy;
  const auto explained = [&](double rms, double noise) {
    noisy.point_noise = noise;
    return explained_misfit(fit_of(rms), noisy);
  };
  CHECK(explained(0.0012, 0.0) == 0.0);
  CHECK(explained(0.0012, 0.0006) == Approx((0.0012 - std::sqrt(0.0012 * 0.0012 - 0.0006 * 0.0006)) / kRadius));
  CHECK(explained(0.0005, 0.001) == Approx(0.0005 / kRadius));                   // all of it
  CHECK(explained(0.00135, 0.00135) == Approx(0.02));                            // the most that counts
  CHECK(explained(0.0018, 0.05) == Approx(explained(0.0018, 0.045 * kRadius)));  // more noise explains no more
  CHECK(explained(0.1, 0.001) == 0.0);  // so far off that noise changes nothing
}

TEST_CASE("a body of a single view is settled by both verdicts, noise and sight lines") {
  Verdict v = verdict_of(cap(1.0));
  v.seen_on = 1.0;
  v.clutter = 1.5;
  const EllipsoidFit fit = fit_of(0.0012);
  BodyParameters parameters;
  const double now = fruit_probability(v, fit, parameters, 0.3);
  const auto odds = [&](double won, const Verdict& last) {
    return exact_log_odds(settled_probability(won, last, fit, parameters, 0.3));
  };
  CHECK(odds(0.2, v) == Approx(0.5 * (exact_log_odds(0.2) + exact_log_odds(now)) - 0.1));
  CHECK(odds(0.9, v) > odds(0.2, v));
  parameters.point_noise = 0.0006;
  CHECK(odds(0.2, v) ==
        Approx(0.5 * (exact_log_odds(0.2) + exact_log_odds(now)) - 0.1 + 75.0 * explained_misfit(fit, parameters)));
  const double radius = fit.body.mean_radius(), before = odds(0.2, v);
  parameters.point_noise = 0.055 * radius;  // all that explains the misfit: more of it only counts against the body
  const double most = odds(0.2, v);
  parameters.point_noise = 0.075 * radius;
  CHECK(odds(0.2, v) == Approx(most - 20.0 * 0.02));
  parameters.point_noise = 0.0006;
  CHECK(odds(0.2, v) == before);
  Verdict through = v;
  through.seen_through = 0.1 * v.coverage;
  CHECK(odds(0.2, through) < odds(0.2, v) - 1.0);
  CHECK(std::isfinite(odds(1.0, v)));
  v.support = 0;
  CHECK(settled_probability(0.9, v, fit, parameters, 0.3) == 0.0);
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

namespace {

void put(Cloud& cloud, const Eigen::Vector3d& direction, double radii, double turned = 0.0) {
  test::add_point(cloud, {Eigen::Vector3d::Zero(), kRadius}, direction, radii, turned);
}

/// A point in the middle of each of the bins of directions [first, last).
Cloud in_bins(std::size_t first, std::size_t last, double radii = 1.0, double turned = 0.0) {
  Cloud cloud;
  for (std::size_t b = first; b < last; ++b) put(cloud, DirectionBins::directions()[b], radii, turned);
  return cloud;
}

Cloud both(Cloud a, const Cloud& b) {
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  a.normals.insert(a.normals.end(), b.normals.begin(), b.normals.end());
  return a;
}

/// The share of the sphere that bins [first, last) have.
double share(std::size_t first, std::size_t last) {
  const auto& shares = DirectionBins::shares();
  return std::accumulate(shares.begin() + static_cast<std::ptrdiff_t>(first),
                         shares.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
}

/// The verdict on a ball with a coverage of bins 0 to 39, and one more point.
Verdict with_point(double radii, double turned = 0.0) {
  Cloud cloud = in_bins(0, 40);
  put(cloud, DirectionBins::directions()[100], radii, turned);
  return verdict_of(cloud);
}

}  // namespace

TEST_CASE("the loose angle between normals is 1.6 times the usual one, at most a right one") {
  BodyParameters parameters;
  parameters.max_angle = deg(35);
  CHECK(loose_cosine(parameters) == Approx(std::cos(deg(56))));
  parameters.max_angle = deg(60);
  CHECK(loose_cosine(parameters) == Approx(0.0).margin(1e-12));
}

TEST_CASE("nothing is known of a body before it is judged") {
  const Verdict v;
  CHECK(v.coverage == 0.0);
  CHECK(v.inside == 0.0);
  CHECK(v.seen_through == 0.0);
  CHECK(v.roundness == 0.0);
  CHECK(v.normal_spread == 0.0);
  CHECK(v.clutter == 0.0);
  CHECK(v.support == 0);
  CHECK_FALSE(v.seen_on);
  CHECK(v.score() == 0.0);
  CHECK(verdict_of({}).score() == 0.0);
}

TEST_CASE("coverage and inside are the shares of the directions with points, each counted once") {
  constexpr std::size_t kAll = DirectionBins::kCount;
  CHECK(verdict_of(in_bins(0, kAll)).coverage == Approx(1.0));
  CHECK(verdict_of(in_bins(0, 1)).coverage == Approx(share(0, 1)).epsilon(1e-9));
  CHECK(verdict_of(in_bins(kAll - 1, kAll)).coverage == Approx(share(kAll - 1, kAll)).epsilon(1e-9));
  const Verdict v = verdict_of(both(both(in_bins(0, 50), in_bins(10, 20)), in_bins(45, 75, 0.5)));
  CHECK(v.coverage == Approx(share(0, 50)).epsilon(1e-9));
  CHECK(v.inside == Approx(share(45, 75)).epsilon(1e-9));
  CHECK(v.support == 60);
  CHECK(v.clutter == 0.0);
  CHECK(v.score() == Approx(share(0, 50) - 2.0 * share(45, 75)));
}

TEST_CASE("where a point counts as on a body, near it, or inside") {
  // The tolerance is 0.08 radii, and 35 degrees between normals.
  CHECK(with_point(1.079).support == 41);
  CHECK(with_point(0.921).support == 41);
  CHECK(with_point(1.079).clutter == 0.0);
  CHECK(with_point(1.079).coverage == Approx(share(0, 40) + share(100, 101)));
  CHECK(with_point(1.0, deg(34)).support == 41);
  for (const Verdict& v :
       {with_point(1.081), with_point(0.919), with_point(1.0, deg(36)), with_point(1.299), with_point(0.801)}) {
    CHECK(v.support == 40);
    CHECK(v.coverage == Approx(share(0, 40)));
    CHECK(v.clutter == Approx(1.0 / 40.0));
    CHECK(v.inside == 0.0);
  }
  CHECK(with_point(1.301).clutter == 0.0);  // too far
  CHECK(with_point(1.36).clutter == 0.0);
  CHECK(with_point(0.799).clutter == 0.0);
  CHECK(with_point(0.799).inside == Approx(share(100, 101)));
  CHECK(with_point(0.799, deg(90)).inside == Approx(share(100, 101)));  // whatever its normal
}

TEST_CASE("points of other bodies are not on one, but still inside it") {
  const Cloud cloud = both(in_bins(0, 40), in_bins(50, 60, 0.5));
  std::vector<char> taken(cloud.size(), 0);
  std::fill(taken.begin(), taken.begin() + 10, char(1));
  std::fill(taken.end() - 10, taken.end(), char(1));
  const Verdict v = judge(cloud, Grid<float>(cloud, 0.006f), taken, fit_of(0.0).body, BodyParameters(), {});
  CHECK(v.support == 30);
  CHECK(v.coverage == Approx(share(10, 40)));
  CHECK(v.inside == Approx(share(50, 60)));
}

TEST_CASE("a body with fewer than eight points is not looked at closely") {
  int asked = 0;
  const SeenThrough through = [&](const Ellipsoid&) { return ++asked, 0.25; };
  const SeenOn on = [&](const Ellipsoid&) { return ++asked, 0.75; };
  const auto of = [&](std::size_t points) {
    Cloud cloud;
    for (std::size_t b = 0; b < points; ++b) put(cloud, DirectionBins::directions()[b * 5], 1.0, deg(20));
    put(cloud, DirectionBins::directions()[100], 1.2);
    return judge(cloud, Grid<float>(cloud, 0.006f), std::vector<char>(cloud.size(), 0), fit_of(0.0).body,
                 BodyParameters(), through, on);
  };
  const Verdict few = of(7);
  CHECK(asked == 0);
  CHECK(few.support == 7);
  CHECK(few.coverage > 0.0);
  CHECK(few.roundness == 0.0);
  CHECK(few.normal_spread == 0.0);
  CHECK(few.clutter == 0.0);
  CHECK(few.seen_through == 0.0);
  CHECK_FALSE(few.seen_on);
  const Verdict enough = of(8);
  CHECK(asked == 2);
  CHECK(enough.support == 8);
  CHECK(enough.normal_spread == Approx(std::sin(deg(20))).epsilon(1e-4));
  CHECK(enough.clutter == Approx(1.0 / 8.0));
  CHECK(enough.seen_through == 0.25);
  CHECK(enough.seen_on == 0.75);
  CHECK(enough.score() == Approx(enough.coverage - 1.5 * 0.25));
}

TEST_CASE("a quick look takes at most 600 points, each for as many as were left out") {
  const auto quickly = [](std::size_t points, bool single_view) {
    Cloud cloud;
    for (std::size_t i = 0; i < points; ++i) put(cloud, DirectionBins::directions()[i % 20], 1.0);
    Indices near(points);
    std::iota(near.begin(), near.end(), Index{0});
    return judge_quickly(cloud, near, std::vector<char>(points, 0), fit_of(0.0).body, BodyParameters(), single_view);
  };
  CHECK(quickly(600, false).support == 600);
  CHECK(quickly(601, false).support == 602);  // every other one, from the first to the last
  CHECK(quickly(1200, false).support == 1200);
  CHECK(quickly(1201, false).support == 1203);
  CHECK(quickly(40, false).coverage == Approx(share(0, 20)));
  CHECK_FALSE(quickly(40, false).seen_on);
  CHECK(quickly(40, true).seen_on == 1.0);  // all of it may have been seen, for all one knows
  CHECK(quickly(0, false).support == 0);
}

TEST_CASE("roundness is the ratio of the curvatures of points and normals by hand") {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.6, Eigen::Vector3d(2, 1, -1).normalized()).toRotationMatrix();
  // Points on a grid whose steps differ, with normals that change with position by `curvatures`, off the center.
  const auto roundness = [&](const Eigen::Vector3d& steps, const Eigen::Matrix3d& curvatures, bool single_view,
                             double radius = 1.0) {
    SupportSums sums;
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3d q = steps.cwiseProduct(Eigen::Vector3d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
      sums.add(turn * (q + Eigen::Vector3d(3, -2, 5)), turn * (curvatures * q + Eigen::Vector3d(0.1, 0.2, 0.3)));
    }
    CHECK(sums.count == 27.0);
    return sums.roundness(radius, single_view);
  };
  const auto diagonal = [](double x, double y, double z) {
    return Eigen::Matrix3d(Eigen::Vector3d(x, y, z).asDiagonal());
  };
  const Eigen::Vector3d flat(2.0, 1.0, 1e-3);
  CHECK(roundness(flat, diagonal(5, 4, 0), true) == Approx(0.8));
  CHECK(roundness(flat, diagonal(2, 5, 0), true) == Approx(0.4));
  CHECK(roundness(flat, diagonal(5, 5, 0), true) == Approx(1.0));
  CHECK(roundness(flat, diagonal(5, 0, 0), true) == Approx(0.0).margin(1e-9));
  CHECK(roundness(flat, diagonal(5, -1, 0), true) == 0.0);   // a saddle
  CHECK(roundness(flat, diagonal(-5, -4, 0), true) == 0.0);  // a hollow
  Eigen::Matrix3d skew = diagonal(5, 5, 0);
  skew(0, 1) = skew(1, 0) = 3.0;  // curvatures of 8 and 2 along the diagonals
  CHECK(roundness(flat, skew, true) == Approx(0.25));
  skew(0, 1) = 6.0, skew(1, 0) = 0.0;  // what turns the normals only does not count
  CHECK(roundness(flat, skew, true) == Approx(0.25));
  // Across the plane: the points' variance there is 2 / 3 of the squared step; at 0.2 radii it counts half.
  const double radius = 2.0, step = 0.4 * std::sqrt(1.5);
  CHECK(roundness({2.0, 1.0, step}, diagonal(5, 5, 3), false, radius) == Approx(0.8));  // half of 5 and half of 3
  CHECK(roundness({2.0, 1.0, step}, diagonal(6, 4, 9), false, radius) == Approx(4.0 / 7.0));
  CHECK(roundness({2.0, 1.0, step}, diagonal(5, 5, -5), false, radius) == 0.0);
  CHECK(roundness({2.0, 1.0, step}, diagonal(5, 5, 3), true, radius) == Approx(1.0));  // not in a single view
  CHECK(roundness({2.0, 1.0, 0.5 * step}, diagonal(5, 5, 0), false, radius) == Approx(16.0 / 17.0));
}

TEST_CASE("what more than enough is known of changes nothing") {
  const Verdict usual = verdict_of(cap(kPi / 2));
  BodyParameters parameters;
  parameters.radius_max = 0.072;  // so that 30 mm are the usual size
  const auto odds = [&](auto&& change, double rms = 0.0005) {
    Verdict v = usual;
    v.support = 400;
    v.roundness = 0.7;
    change(v);
    return exact_log_odds(fruit_probability(v, fit_of(rms), parameters));
  };
  const auto same = [](Verdict&) {};
  const auto support = [&](std::size_t n) { return odds([n](Verdict& v) { v.support = n, v.normal_spread = 0.3; }); };
  CHECK(support(1500) == Approx(support(9000)));
  CHECK(support(1400) < support(1500));
  CHECK(support(800) - support(400) == Approx(support(400) - support(200)));  // by the logarithm
  const auto round = [&](double r) { return odds([r](Verdict& v) { v.roundness = r; }); };
  CHECK(round(0.8) == Approx(round(0.9)));
  CHECK(round(0.79) < round(0.8));
  CHECK(round(0.8) - round(0.7) == Approx(round(0.7) - round(0.6)));
  CHECK(odds(same, 0.08 * kRadius) == Approx(odds(same, 0.2 * kRadius)));
  CHECK(odds(same, 0.075 * kRadius) > odds(same, 0.08 * kRadius));
  const auto sized = [&](double radius) {
    Verdict v = usual;
    v.support = 400, v.seen_on = 1.0;
    EllipsoidFit fit;
    fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), radius});
    return exact_log_odds(fruit_probability(v, fit, parameters));
  };
  CHECK(sized(0.037) == Approx(sized(0.070)));
  CHECK(sized(0.030) < sized(0.035));
  // What is known from elsewhere adds up.
  for (const double prior : {-2.0, -0.5, 1.0})
    CHECK(exact_log_odds(fruit_probability(usual, fit_of(0.003), parameters, prior)) ==
          Approx(exact_log_odds(fruit_probability(usual, fit_of(0.003), parameters)) + prior));
  Verdict none = usual;
  none.coverage = 0.0;
  CHECK(fruit_probability(none, fit_of(0.0), parameters) == 0.0);
  none = usual;
  none.support = 1;
  CHECK(fruit_probability(none, fit_of(0.0), parameters) > 0.0);
  none.support = 0;
  CHECK(fruit_probability(none, fit_of(0.0), parameters) == 0.0);
}

TEST_CASE("sight lines through a body and points inside count against what is covered") {
  const Verdict usual = verdict_of(cap(kPi / 2));
  const auto odds = [&](double coverage, double through, double inside) {
    Verdict v = usual;
    v.normal_spread = 0.3;
    v.coverage = coverage, v.seen_through = through, v.inside = inside;
    return exact_log_odds(fruit_probability(v, fit_of(0.0005), BodyParameters()));
  };
  CHECK(odds(0.5, 0.1, 0.0) == Approx(odds(0.25, 0.05, 0.0)));  // shares of what is known
  CHECK(odds(0.5, 0.0, 0.1) == Approx(odds(0.25, 0.0, 0.05)));
  CHECK(odds(0.5, 0.0, 0.0) == Approx(odds(0.1, 0.0, 0.0)));
  const double by_inside = odds(0.5, 0.0, 0.0) - odds(0.5, 0.0, 0.05);
  CHECK(by_inside > 0.3);
  CHECK(odds(0.5, 0.0, 0.0) - odds(0.5, 0.0, 0.1) == Approx(2.0 * by_inside));
  // A quarter of what is known was seen through, or half of it.
  CHECK(odds(0.3, 0.0, 0.0) - odds(0.3, 0.3, 0.0) == Approx(2.0 * (odds(0.3, 0.0, 0.0) - odds(0.3, 0.1, 0.0))));
}
