// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/body_verdict.hpp>

#include <numeric>
#include <random>

#include "catch.hpp"
#include "cloud/judged_sphere.hpp"
#include "spheres.hpp"

namespace body_verdict_test {

using namespace agrisee;
using namespace agrisee::detail;
using namespace agrisee::test;

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
                 BodyParameters(), {through, on});
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

}  // namespace body_verdict_test
