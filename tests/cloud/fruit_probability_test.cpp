// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/fruit_probability.hpp>

#include <optional>

#include "catch.hpp"
#include "cloud/judged_sphere.hpp"

namespace fruit_probability_test {

using namespace agrisee;
using namespace agrisee::detail;
using namespace agrisee::test;

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

namespace {

/// Parameters of a scan of several views with noise of its normals (rad).
BodyParameters of_scan(double normal_noise) {
  BodyParameters parameters;
  parameters.alike = 0.0;
  parameters.normal_noise = normal_noise;
  return parameters;
}

/// Log-odds of a body of this radius (m) on which half a sphere was seen, with other evidence.
template <typename Change>
double changed_odds(double radius, const BodyParameters& parameters, Change&& change) {
  Verdict v = verdict_of(cap(kPi / 2));
  v.roundness = 0.7;
  v.normal_spread = 0.3;
  change(v);
  EllipsoidFit fit;
  fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), radius});
  return log_odds(fruit_probability(v, fit, parameters));
}

}  // namespace

TEST_CASE("at much noise, normals speak less against small bodies in several views") {
  const auto by_spread = [](double radius, const BodyParameters& parameters, std::optional<double> seen_on = {}) {
    return changed_odds(radius, parameters, [&](Verdict& v) { v.seen_on = seen_on, v.normal_spread = 0.0; }) -
           changed_odds(radius, parameters, [&](Verdict& v) { v.seen_on = seen_on; });
  };
  CHECK(by_spread(0.012, of_scan(0.15)) < by_spread(0.020, of_scan(0.15)) - 0.1);  // patches are wide against the body
  CHECK(by_spread(0.014, of_scan(0.0)) == Approx(by_spread(0.020, of_scan(0.0))));
  CHECK(by_spread(0.012, of_scan(0.15), 1.0) == Approx(by_spread(0.020, of_scan(0.15), 1.0)));
  BodyParameters few_views = of_scan(0.15);
  few_views.alike = 0.7;
  CHECK(by_spread(0.014, few_views) == Approx(by_spread(0.020, few_views)));
}

TEST_CASE("at much noise, a body's own points whose normals are off are no clutter, up to a share of them") {
  const auto by_clutter = [](double turned, const BodyParameters& parameters, std::optional<double> seen_on = {}) {
    return changed_odds(0.02, parameters,
                        [&](Verdict& v) { v.clutter = 1.0, v.turned = turned, v.seen_on = seen_on; }) -
           changed_odds(0.02, parameters, [&](Verdict& v) { v.clutter = 1.0, v.seen_on = seen_on; });
  };
  CHECK(by_clutter(0.4, of_scan(0.0)) == Approx(0.0).margin(1e-9));
  CHECK(by_clutter(0.4, of_scan(0.15)) == Approx(2.32 * std::log(2.0 / 1.6)));
  CHECK(by_clutter(0.2, of_scan(0.15)) == Approx(2.32 * std::log(2.0 / 1.8)));
  CHECK(by_clutter(0.9, of_scan(0.3)) == Approx(by_clutter(0.4, of_scan(0.15))));
  CHECK(by_clutter(0.4, of_scan(0.15), 1.0) == Approx(0.0).margin(1e-9));
  BodyParameters few_views = of_scan(0.15);
  few_views.alike = 0.7;
  CHECK(by_clutter(0.4, few_views) == Approx(0.0).margin(1e-9));
}

TEST_CASE("at much noise, a body below the smallest expected radius is less likely a fruit") {
  const auto by_least = [](double least, double noise, double alike) {
    BodyParameters narrower = of_scan(noise), usual = of_scan(noise);
    narrower.alike = usual.alike = alike;
    narrower.radius_min = least;
    const auto same = [](Verdict&) {};
    return changed_odds(0.01, narrower, same) - changed_odds(0.01, usual, same);
  };
  CHECK(by_least(0.0100, 0.15, 0.0) == Approx(0.0).margin(1e-9));
  CHECK(by_least(0.0105, 0.15, 0.0) == Approx(-2.0));
  CHECK(by_least(0.0105, 0.0, 0.0) == Approx(0.0).margin(1e-9));
  CHECK(by_least(0.0105, 0.15, 0.7) == Approx(0.0).margin(1e-9));  // in one or two views
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

namespace {

/// A tube about the x axis of 16 mm radius and 60 mm length, with or without round ends.
Cloud tube(bool round_ends) {
  constexpr double kTube = 0.016, kHalf = 0.03, kStep = 0.0015;
  const auto around = static_cast<int>(2 * kPi * kTube / kStep);
  Cloud cloud;
  const auto add_ring = [&](double x, double radius, double nx) {
    for (int i = 0; i < around; ++i) {
      const double a = 2 * kPi * i / around, across = std::sqrt(1.0 - nx * nx);
      cloud.points.push_back(Eigen::Vector3d(x, radius * std::cos(a), radius * std::sin(a)).cast<float>());
      cloud.normals.push_back(Eigen::Vector3d(nx, across * std::cos(a), across * std::sin(a)).cast<float>());
    }
  };
  for (double x = -kHalf; x <= kHalf; x += kStep) add_ring(x, kTube, 0.0);
  for (double x = kStep; round_ends && x < kTube; x += kStep)
    for (const double side : {-1.0, 1.0})
      add_ring(side * (kHalf + x), std::sqrt(kTube * kTube - x * x), side * x / kTube);
  return cloud;
}

}  // namespace

TEST_CASE("a capsule that several views show from end to end is round enough, a piece of pipe is not") {
  for (const bool round_ends : {true, false}) {
    const Cloud cloud = tube(round_ends);
    const Grid<float> grid(cloud, 0.006f);
    Ellipsoid body(Sphere{Eigen::Vector3d::Zero(), 1.0});
    body.A = Eigen::Vector3d(1.0 / 0.048, 1.0 / 0.0165, 1.0 / 0.0165).asDiagonal();
    const Verdict v = judge(cloud, grid, std::vector<char>(cloud.size(), 0), body, BodyParameters(), {});
    INFO("roundness " << v.roundness << ", coverage " << v.coverage);
    CHECK(v.closed());
    CHECK(v.roundness < BodyParameters().min_roundness);
    CHECK(round_enough(v, body, BodyParameters()) == round_ends);
  }
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
  v.roundness = 0.9;  // counts as 0.8
  const EllipsoidFit fit = fit_of(0.0012);
  BodyParameters parameters;
  const double now = fruit_probability(v, fit, parameters, 0.3);
  const auto odds = [&](double won, const Verdict& last) {
    return exact_log_odds(settled_probability(won, last, fit, parameters, 0.3));
  };
  const double both = 0.5 * (exact_log_odds(0.2) + exact_log_odds(now)) + 2.5 * 0.8 - 1.45;
  CHECK(odds(0.2, v) == Approx(both));
  CHECK(odds(0.9, v) > odds(0.2, v));
  Verdict flat = v;
  flat.roundness = 0.6;  // counts in the verdict, too
  CHECK(odds(0.2, flat) == Approx(both - 2.5 * 0.2 - 0.5 * 1.55 * 0.2));
  parameters.normal_noise = 0.3;
  const double noisy = odds(0.2, v);
  parameters.normal_noise = 0.4;  // explains no more of the spread than all, but says that normals are random
  CHECK(odds(0.2, v) == Approx(noisy - 30.0 * 0.1));
  parameters.normal_noise = 0.0;
  parameters.point_noise = 0.0006;
  CHECK(odds(0.2, v) == Approx(both + 75.0 * explained_misfit(fit, parameters)));
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

}  // namespace fruit_probability_test
