// SPDX-License-Identifier: BSD-3-Clause
// Who gets which point, by hand.
#include <agrisee/cloud/split.hpp>

#include <algorithm>
#include <numeric>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace split_test {

namespace {

/// The grid in which bodies find the points near them.
Grid<float> grid_of(const Cloud& cloud, const BodyParameters& parameters = {}) {
  return Grid<float>(cloud, static_cast<float>(parameters.cell()));
}

constexpr double kRadius = 0.03;
const Eigen::Vector3d kCenter(0.0, 0.5, 0.2);

FoundBody ball(const Eigen::Vector3d& center = kCenter, double radius = kRadius) {
  FoundBody body;
  body.fit.body = Ellipsoid(Sphere{center, radius});
  return body;
}

/// A point before the ball, at some radii from its center, its normal turned away by an angle.
void put(Cloud& cloud, double radii, double turned = 0.0) {
  test::add_point(cloud, {kCenter, kRadius}, -Eigen::Vector3d::UnitY(), radii, turned);
}

/// The front of the ball, with two points in each direction: one outside it and one as far inside.
Cloud rough_front(double off, double spacing = 0.0025) {
  Cloud front, out;
  test::add_sphere(front, {kCenter, kRadius}, spacing, [](const Eigen::Vector3d& d) { return d.y() < 0.1; });
  for (std::size_t i = 0; i < front.size(); ++i)
    for (const double side : {-1.0, 1.0}) {
      out.points.push_back(
          (front.points[i].cast<double>() + side * off * front.normals[i].cast<double>()).cast<float>());
      out.normals.push_back(front.normals[i]);
    }
  return out;
}

}  // namespace

TEST_CASE("the bodies of a split are fitted to all their points, not to some") {
  const Cloud cloud = rough_front(0.0006, 0.0015);
  REQUIRE(cloud.size() > 5000);
  const Split found = split(cloud);
  REQUIRE(found.found.size() == 1);
  CHECK((found.found[0].fit.body.center - kCenter).norm() < 4e-6);  // the errors of each pair cancel
  CHECK(found.found[0].fit.body.mean_radius() == Approx(kRadius).margin(4e-6));
  CHECK(found.found[0].fit.inliers == cloud.size());
  CHECK(found.found[0].fit.rms == Approx(0.0006).epsilon(0.01));
  CHECK(found.labels == Labels(cloud.size(), 1));
}

TEST_CASE("region growing by curvature needs nothing but the cloud") {
  const Cloud smooth = rough_front(0.0, 0.0015);
  SplitParameters stages = SplitParameters::paper(), bodies;
  for (SplitParameters* p : {&stages, &bodies}) {
    const Split usual = split(smooth, *p);
    p->growing.seeds_by_curvature = true;
    p->growing.max_curvature = 0.3;
    const Split found = split(smooth, *p);  // a ball is as smooth everywhere
    CHECK(found.regions_found == 1);
    CHECK(found.regions == usual.regions);
    CHECK(found.labels == usual.labels);
    CHECK(split(smooth, *p, {}, 3).labels == found.labels);
    p->growing.max_curvature = 0.0;  // no point of a curved surface grows a region
    CHECK(split(smooth, *p).regions_found == 0);
  }
}

TEST_CASE("the last fit moves a body to its points, those of masks stay") {
  const Cloud cloud = rough_front(0.0);
  Split out;
  out.labels.assign(cloud.size(), 1);
  out.found = {ball(kCenter + Eigen::Vector3d(0.002, 0, 0.001), 0.0305)};
  Split mask = out;
  mask.found[0].by_mask = true;
  detail::refit(cloud, grid_of(cloud, BodyParameters()), BodyParameters(), out.found, out.labels);
  CHECK((out.found[0].fit.body.center - kCenter).norm() < 1e-5);
  CHECK(out.labels == Labels(cloud.size(), 1));
  const Eigen::Vector3d before = mask.found[0].fit.body.center;
  detail::refit(cloud, grid_of(cloud, BodyParameters()), BodyParameters(), mask.found, mask.labels);
  CHECK(mask.found[0].fit.body.center == before);
  // One that becomes too large stays as it was.
  Split large = out;
  BodyParameters small;
  small.radius_min = 0.01, small.radius_max = 0.025;
  large.found = {ball(kCenter, 0.0287)};
  detail::refit(cloud, grid_of(cloud, small), small, large.found, large.labels);
  CHECK(large.found[0].fit.body.mean_radius() == Approx(0.0287));
}

TEST_CASE("after the last fit the points are given out anew") {
  Cloud cloud = rough_front(0.0);
  put(cloud, 2.0);  // not near the ball
  Split out;
  out.labels.assign(cloud.size(), 1);
  out.found = {ball()};
  detail::refit(cloud, grid_of(cloud, BodyParameters()), BodyParameters(), out.found, out.labels);
  CHECK(out.labels.back() == 0);
  CHECK(std::accumulate(out.labels.begin(), out.labels.end(), 0) + 1 == static_cast<int>(cloud.size()));
}

TEST_CASE("a split gives a fruit the points of a dimple, and counts balls that are too large") {
  Cloud cloud = rough_front(0.0);
  const std::size_t whole = cloud.size();
  for (int i = 0; i < 5; ++i) put(cloud, 0.75 + 0.01 * i);
  const Split found = split(cloud);
  REQUIRE(found.found.size() == 1);
  for (std::size_t i = whole; i < cloud.size(); ++i) CHECK(found.labels[i] == 1);
  CHECK(found.bodies.too_large == 0);

  Cloud large;
  test::add_sphere(large, {kCenter, 0.2}, 0.01, test::everywhere);
  const Split none = split(large);
  CHECK(none.found.empty());
  CHECK(none.bodies.too_large == 1);
}

TEST_CASE("in a single view points count as fewer, and the size of the other fruit as more") {
  const Cloud cloud = rough_front(0.0);
  const auto variance = [&](bool sized, int independent) {
    Split out;
    out.labels.assign(cloud.size(), 1);
    out.found = {ball()};
    if (sized) out.found[0].fit.size_prior = SizePrior{kRadius, 10.0};  // it says nothing
    BodyParameters parameters;
    parameters.fit.independent = independent;
    parameters.fit.shape_prior = 10.0;  // nor does this
    detail::refit(cloud, grid_of(cloud, parameters), parameters, out.found, out.labels);
    return out.found[0].fit.center_covariance(0, 0);
  };
  CHECK(variance(true, 150) / variance(false, 150) == Approx(150.0 / 60.0).epsilon(0.01));
  CHECK(variance(true, 40) == Approx(variance(false, 40)).epsilon(0.001));
}

TEST_CASE("in a single view the last verdict decides: a doubtful body that it believes stays, another goes") {
  const Cloud cloud = rough_front(0.0002);
  const auto settled = [&](double won, double seen_on, bool by_mask = false) {
    Split out;
    out.found = {ball()};
    out.found[0].confidence = won;
    out.found[0].by_mask = by_mask;
    out.bodies.taken = 1;
    detail::settle(cloud, grid_of(cloud), BodyParameters(), BodyParameters(),
                   {{}, [&](const Ellipsoid&) { return seen_on; }}, out);
    CHECK(out.bodies.taken == out.found.size());
    CHECK(out.bodies.doubtful == 1 - out.found.size());
    const auto labeled = std::count(out.labels.begin(), out.labels.end(), 1);
    CHECK((out.found.empty() ? labeled == 0 : labeled > 1000));
    return out;
  };
  const Split kept = settled(0.1, 1.0);
  REQUIRE(kept.found.size() == 1);
  CHECK(kept.found[0].confidence > 0.5);
  const Split gone = settled(0.1, 0.02);
  CHECK(gone.found.empty());
  CHECK(std::count(gone.labels.begin(), gone.labels.end(), 0) == static_cast<int>(cloud.size()));
  CHECK(settled(0.6, 0.02, true).found.size() == 1);  // masks have decided
}

TEST_CASE("in a single view smaller bodies are sought than expected, but not kept") {
  Cloud cloud = rough_front(0.0002);
  const Eigen::Vector3d aside(0.08, 0.5, 0.2);
  test::add_sphere(cloud, {aside, 0.012}, 0.0015, [](const Eigen::Vector3d& d) { return d.y() < 0.1; });
  const auto found = [&](double radius_min) {
    SplitParameters parameters;
    parameters.bodies.radius_min = radius_min;
    return split(cloud, parameters, {{}, [](const Ellipsoid&) { return 1.0; }});
  };
  const Split both = found(0.008), one = found(0.025);
  CHECK(both.found.size() == 2);
  REQUIRE(one.found.size() == 1);
  CHECK(one.found[0].fit.body.mean_radius() == Approx(kRadius).epsilon(0.02));
  CHECK(one.bodies.too_small == both.bodies.too_small + 1);
  CHECK(one.bodies.taken == 1);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if ((cloud.points[i].cast<double>() - aside).norm() < 0.02) CHECK(one.labels[i] == 0);
  // Where the largest fruit are small, nothing below 8 mm is sought.
  BodyParameters small;
  small.radius_min = 0.01;
  small.radius_max = 0.016;
  CHECK(detail::sought_in_single_view(small).radius_min == 0.008);
  small.radius_min = 0.005;
  CHECK(detail::sought_in_single_view(small).radius_min == 0.005);
}

TEST_CASE("a region belongs to a body that has 60 percent of its points") {
  const auto owners = [](const Labels& labels, const Labels& regions) {
    return detail::owners_of_regions(labels, 2, regions, 2);
  };
  using Owners = std::vector<std::size_t>;
  CHECK(owners({1, 1, 1, 2, 0, 2}, {1, 1, 1, 1, 1, 2}) == Owners{0, 1, 2});
  CHECK(owners({0, 2, 2, 2, 1, 0}, {1, 2, 2, 2, 2, 2}) == Owners{0, 0, 2});
  CHECK(owners({1, 1, 0, 2, 0, 1}, {1, 1, 1, 1, 1, 2}) == Owners{0, 0, 1});
  CHECK(owners({1, 1, 1, 0, 0, 0, 2}, {1, 1, 1, 1, 1, 0, 2}) == Owners{0, 1, 2});
  CHECK(owners({1, 1, 1, 0, 0}, {0, 0, 0, 1, 2}) == Owners{0, 0, 0});  // in no region
  CHECK(detail::owners_of_regions({0, 0}, 0, {1, 1}, 1) == Owners{0, 0});
}

TEST_CASE("a body was found by the segment with half of the points of both, else by the vote") {
  detail::Segments segments;
  segments.labels = {1, 1, 1, 1, 0, 0, 2, 2, 2, 2};
  segments.first_cluster = 2;
  const std::vector<std::size_t> sizes{0, 4, 4};
  CHECK(detail::found_by({0, 1, 2, 3}, segments, sizes) == "region_growing");
  CHECK(detail::found_by({6, 7, 8, 9}, segments, sizes) == "dbscan");
  CHECK(detail::found_by({0, 1, 4, 5}, segments, sizes) ==
        "region_growing");  // half of its points, half of the segment
  CHECK(detail::found_by({0, 4, 5}, segments, sizes) == "sphere_voting");
  CHECK(detail::found_by({0}, segments, sizes) == "sphere_voting");            // a quarter of the segment
  CHECK(detail::found_by({0, 1, 6, 7}, segments, sizes) == "region_growing");  // of equal ones the first
  CHECK(detail::found_by({0, 6, 7, 8}, segments, sizes) == "dbscan");
  CHECK(detail::found_by({4, 5}, segments, sizes) == "sphere_voting");
  CHECK(detail::found_by({4, 5}, detail::Segments{segments.labels, {}, 1}, {0}) == "sphere_voting");
}

TEST_CASE("a body has changed if one point of twenty near it is fresh") {
  Cloud cloud;
  for (int i = 0; i < 40; ++i) put(cloud, 1.0 + 0.008 * i);  // up to 1.31 radii
  put(cloud, 1.37);                                          // no longer near
  const Grid<float> grid(cloud, 0.01f);
  std::vector<char> fresh(cloud.size(), 0);
  const auto changed = [&] { return detail::has_changed(grid, ball().fit.body, fresh); };
  fresh[40] = 1, fresh[39] = 1;
  CHECK_FALSE(changed());
  fresh[0] = 1;
  CHECK(changed());
  fresh[39] = 0;
  CHECK_FALSE(changed());
}

TEST_CASE("points in dimples and on shoulders of a body become its own") {
  const auto label = [](double radii, double turned, int region, int before = 0) {
    Cloud cloud;
    put(cloud, radii, turned);
    for (int i = 0; i < 9; ++i) put(cloud, 1.0);  // region 1 is the body's
    Labels labels(10, 1), regions(10, 1);
    labels[0] = before, regions[0] = region;
    const auto far = ball(kCenter + Eigen::Vector3d(0, 0, 1));
    detail::extend_labels(labels, cloud, {ball(), far}, regions, 1, BodyParameters());
    CHECK(std::accumulate(labels.begin() + 1, labels.end(), 0) == 9);
    return labels[0];
  };
  // Points of its region: within a quarter of the radius, and not turned away.
  CHECK(label(1.24, deg(80), 1) == 1);
  CHECK(label(1.26, 0.0, 1) == 0);
  CHECK(label(1.24, deg(100), 1) == 0);
  CHECK(label(0.76, deg(80), 1) == 1);
  // Others: up to 0.4 radii inside and half of the tolerance outside, if their normals agree.
  CHECK(label(0.62, 0.0, 0) == 1);
  CHECK(label(0.58, 0.0, 0) == 0);
  CHECK(label(1.038, 0.0, 0) == 1);
  CHECK(label(1.042, 0.0, 0) == 0);
  CHECK(label(0.9, deg(70), 0) == 1);
  CHECK(label(0.9, deg(75), 0) == 0);
  CHECK(label(1.0, 0.0, 1, 2) == 2);  // of another body
}

TEST_CASE("a point between bodies becomes that of the first") {
  Cloud cloud;
  put(cloud, 0.9);
  Labels labels{0};
  detail::extend_labels(labels, cloud, {ball(kCenter + Eigen::Vector3d(0, 0, 1)), ball(), ball()}, {0}, 0,
                        BodyParameters());
  CHECK(labels == Labels{2});
}

TEST_CASE("segments are the regions, then the clusters of what is left") {
  // A smooth ball, and far from it a heap of points without normals, which no region grows over.
  Cloud cloud;
  test::add_sphere(cloud, {kCenter, kRadius}, 0.002, test::everywhere);
  const std::size_t own = cloud.size();
  for (int i = 0; i < 125; ++i) {
    cloud.points.emplace_back(0.3f + 0.002f * float(i % 5), 0.5f + 0.002f * float(i / 5 % 5), 0.002f * float(i / 25));
    cloud.normals.push_back(Eigen::Vector3f::Zero());
  }
  StageParameters stages;
  stages.growing.radius = 0.0045, stages.growing.min_size = 100;
  stages.clustering.eps = 0.0045, stages.clustering.min_points = 8;
  stages.min_residual = 124, stages.min_cluster = 125;
  Split out;
  detail::Segments segments = detail::find_segments(cloud, stages, 1, out);
  CHECK(out.regions_found == 1);
  CHECK(out.clusters_found == 1);
  CHECK(out.residual == 125);
  REQUIRE(segments.members.size() == 2);
  CHECK(segments.members[0].size() == own);
  CHECK(segments.members[0].front() == 0);
  CHECK(segments.members[1].size() == 125);
  CHECK(segments.members[1].back() == static_cast<Index>(cloud.size() - 1));
  CHECK(segments.first_cluster == 2);
  CHECK(segments.found_by(1) == std::string("region_growing"));
  CHECK(segments.found_by(2) == std::string("dbscan"));
  CHECK(out.regions[0] == 1);
  CHECK(out.regions[own] == 0);
  CHECK(segments.labels[own] == 2);
  stages.min_cluster = 126;  // too few for a cluster
  CHECK(detail::find_segments(cloud, stages, 1, out).members.size() == 1);
  CHECK(out.clusters_found == 0);
  stages.min_cluster = 1, stages.min_residual = 125;  // too few to look for clusters
  out = {};
  CHECK(detail::find_segments(cloud, stages, 1, out).members.size() == 1);
  CHECK(out.clusters_found == 0);
  CHECK(out.residual == 125);
}

TEST_CASE("a point gets the nearest body within the tolerance whose normal agrees") {
  const auto label = [](double radii, double turned, const std::vector<FoundBody>& bodies) {
    Cloud cloud;
    put(cloud, radii, turned);
    return assign_to_bodies(cloud, bodies)[0];
  };
  CHECK(label(1.079, 0.0, {ball()}) == 1);
  CHECK(label(1.081, 0.0, {ball()}) == 0);
  CHECK(label(0.921, 0.0, {ball()}) == 1);
  CHECK(label(0.919, 0.0, {ball()}) == 0);
  CHECK(label(1.0, deg(55), {ball()}) == 1);  // 1.6 times 35 degrees
  CHECK(label(1.0, deg(57), {ball()}) == 0);
  CHECK(label(1.03, 0.0, {ball(), ball(kCenter, 1.02 * kRadius)}) == 2);
  CHECK(label(1.03, 0.0, {ball(kCenter, 1.02 * kRadius), ball()}) == 1);
  CHECK(label(1.0, 0.0, {}) == 0);
}

}  // namespace split_test
