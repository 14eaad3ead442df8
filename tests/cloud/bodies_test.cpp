// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/split.hpp>
#include <agrisee/geometry/spiral.hpp>

#include <algorithm>

#include "catch.hpp"
#include "cloud/cloud_cases.hpp"
#include "spheres.hpp"

using namespace agrisee;
using test::Sphere;

namespace {

Eigen::Vector3d front() { return -Eigen::Vector3d::UnitY(); }

/// A curved leaf: part of a cylinder of radius 40 mm, 50 x 70 mm.
void add_leaf(Cloud& cloud, const Eigen::Vector3d& at) {
  for (double s = -0.6; s <= 0.6; s += 0.06)
    for (double z = 0.0; z < 0.07; z += 0.0024) {
      const Eigen::Vector3d n(std::sin(s), -std::cos(s), 0.0);
      cloud.points.push_back((at + 0.04 * n + z * Eigen::Vector3d::UnitZ()).cast<float>());
      cloud.normals.push_back(n.cast<float>());
    }
}

void add_stem(Cloud& cloud, const Eigen::Vector3d& at) {
  for (double a = 0.0; a < 6.2; a += 0.6)
    for (double z = 0.0; z < 0.3; z += 0.0024) {
      const Eigen::Vector3d n(std::cos(a), std::sin(a), 0.0);
      cloud.points.push_back((at + 0.004 * n + z * Eigen::Vector3d::UnitZ()).cast<float>());
      cloud.normals.push_back(n.cast<float>());
    }
}

}  // namespace

TEST_CASE("a sphere is fitted from a crescent of it") {
  const Sphere truth{{0.1, 0.5, 0.3}, 0.035};
  Cloud cloud;
  test::add_sphere(
      cloud, truth, 0.0025, [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.3 && d.x() > 0.2; }, 0.0005);
  const Indices all = cases::all_of(cloud);
  const auto start = sphere_from_normals(cloud, all);
  REQUIRE(start);
  CHECK((start->center - truth.center).norm() < 0.002);
  CHECK(start->radius == Approx(truth.radius).margin(0.002));
  const auto fit = fit_ellipsoid(cloud, all, Ellipsoid(*start));
  REQUIRE(fit);
  CHECK((fit->body.center - truth.center).norm() < 0.001);
  CHECK(fit->body.mean_radius() == Approx(truth.radius).margin(0.001));
  CHECK(fit->center_covariance.trace() > 0.0);
}

TEST_CASE("an ellipsoid is fitted where the data tell its shape") {
  const Eigen::Vector3d radii(0.040, 0.036, 0.031);
  const Eigen::Matrix3d axes = pose_from_xyz_rpy({0, 0, 0}, {0.4, -0.7, 1.1}).linear();
  const Eigen::Vector3d center(-0.2, 0.4, 0.1);
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0, 0}, 1.0}, 0.06, test::everywhere);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d d = cloud.normals[i].cast<double>();
    cloud.points[i] = (center + axes * radii.cwiseProduct(d)).cast<float>();
    cloud.normals[i] = (axes * d.cwiseQuotient(radii)).normalized().cast<float>();
  }
  const Indices all = cases::all_of(cloud);
  const auto fit = fit_ellipsoid(cloud, all, Ellipsoid(Sphere{center + Eigen::Vector3d(0.003, 0, 0.002), 0.034}));
  REQUIRE(fit);
  const auto [found, directions] = semi_axes(fit->body);
  CHECK((fit->body.center - center).norm() < 2e-4);
  for (int a = 0; a < 3; ++a) {
    CHECK(found[a] == Approx(radii[a]).margin(8e-4));
    CHECK(std::abs(directions.col(a).dot(axes.col(a))) > 0.99);
  }
  CHECK(directions.determinant() == Approx(1.0));
}

TEST_CASE("fits of nothing are none") {
  Cloud cloud;
  CHECK_FALSE(sphere_from_normals(cloud, {}));
  CHECK_FALSE(fit_ellipsoid(cloud, {}, Ellipsoid(Sphere{{0, 0, 0}, 0.03})));
  for (int i = 0; i < 100; ++i) {  // all points and normals equal
    cloud.points.emplace_back(0.1f, 0.2f, 0.3f);
    cloud.normals.emplace_back(0.0f, 0.0f, 1.0f);
  }
  const Indices all = cases::all_of(cloud);
  CHECK_FALSE(sphere_from_normals(cloud, all));
  cloud.normals.clear();
  CHECK_THROWS_AS(fit_ellipsoid(cloud, all, Ellipsoid(Sphere{{0, 0, 0}, 0.03})), InputError);
}

TEST_CASE("touching fruit, one behind the others, leaf and stem: each fruit is found and nothing else") {
  const std::vector<Sphere> fruit = {{{-0.036, 0.50, 0.20}, 0.036},
                                     {{0.034, 0.50, 0.21}, 0.033},
                                     {{0.0, 0.555, 0.205}, 0.034},
                                     {{0.0, 0.50, 0.135}, 0.030}};
  Cloud cloud;
  for (std::size_t f = 0; f < fruit.size(); ++f) {
    const bool hidden = f == 2;
    test::add_sphere(
        cloud, fruit[f], 0.0025,
        [&](const Eigen::Vector3d& d) {
          return hidden ? d.dot(Eigen::Vector3d(0.8, -0.3, 0.5)) > 0.55 : d.dot(front()) > 0.15;
        },
        0.0006, f + 1);
  }
  const std::size_t fruit_points = cloud.size();
  add_leaf(cloud, {0.11, 0.50, 0.16});
  add_stem(cloud, {0.0, 0.47, 0.24});
  const Split found = split(cloud);
  REQUIRE(found.found.size() == fruit.size());
  for (const Sphere& s : fruit) {
    double best = 1.0, radius = 0.0;
    for (const FoundBody& b : found.found)
      if ((b.fit.body.center - s.center).norm() < best) {
        best = (b.fit.body.center - s.center).norm();
        radius = b.fit.body.mean_radius();
      }
    CHECK(best < 0.0015);
    CHECK(radius == Approx(s.radius).margin(0.001));
  }
  std::size_t wrong = 0, missed = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    (i < fruit_points ? missed : wrong) += (found.labels[i] == 0) == (i < fruit_points);
  CHECK(missed < fruit_points / 50);
  CHECK(wrong < (cloud.size() - fruit_points) / 50);
}

TEST_CASE("the split does not depend on threads, with bodies or without") {
  Cloud cloud;
  for (const double x : {-0.036, 0.034})
    test::add_sphere(
        cloud, {{x, 0.50, 0.20}, 0.034}, 0.0025, [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.1; }, 0.0006);
  for (std::size_t i = 0; i < cloud.size(); i += 3) cloud.normals[i].setZero();  // a residual, for DBSCAN
  add_stem(cloud, {0.0, 0.47, 0.24});
  SplitParameters p;
  p.growing.smoothness = deg(4.0);
  for (const bool bodies : {true, false}) {
    p.fit_bodies = bodies;
    const Split one = split(cloud, p), three = split(cloud, p, {}, 3);
    CHECK(one.residual > 0);
    CHECK(one.labels == three.labels);
    CHECK(one.regions == three.regions);
    CHECK(one.clusters_found == three.clusters_found);
    if (!bodies) {  // the regions come first, then the clusters
      std::vector<std::string> by(static_cast<std::size_t>(one.regions_found), "region_growing");
      by.resize(by.size() + static_cast<std::size_t>(one.clusters_found), "dbscan");
      REQUIRE(one.regions_found > 0);
      REQUIRE(one.clusters_found > 0);
      REQUIRE(one.found.size() == by.size());
      for (std::size_t b = 0; b < by.size(); ++b) CHECK(one.found[b].found_by == by[b]);
    }
    REQUIRE(one.found.size() == three.found.size());
    for (std::size_t b = 0; b < one.found.size(); ++b) {
      CHECK(one.found[b].found_by == three.found[b].found_by);
      CHECK(one.found[b].fit.body.center == three.found[b].fit.body.center);
    }
  }
}

TEST_CASE("a body that sight lines went through is none") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0.5, 0.2}, 0.035}, 0.0025,
                   [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.5; });
  CHECK(split(cloud).found.size() == 1);
  CHECK(split(cloud, {}, {[](const Ellipsoid&) { return 0.5; }}).found.empty());
}

TEST_CASE("smaller and larger fruit need another radius range and nothing else") {
  for (const double scale : {0.4, 1.0, 2.5}) {
    Cloud cloud;
    test::add_sphere(
        cloud, {scale * Eigen::Vector3d(0, 0.5, 0.2), scale * 0.035}, scale * 0.0025,
        [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.0; }, scale * 0.0003);
    test::add_sphere(
        cloud, {scale * Eigen::Vector3d(0.068, 0.5, 0.21), scale * 0.033}, scale * 0.0025,
        [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.0; }, scale * 0.0003);
    SplitParameters p;
    p.bodies.radius_min *= scale;
    p.bodies.radius_max *= scale;
    p.bodies.fit.noise *= scale;
    const Split found = split(cloud, p);
    CHECK(found.found.size() == 2);
  }
}

TEST_CASE("a body is too large by any mean of its semi-axes") {
  const auto found = [](const Eigen::Vector3d& radii) {
    Cloud ball, cloud;
    test::add_sphere(ball, {{0, 0, 0}, 1.0}, 0.05, test::everywhere);
    for (const auto& p : ball.points) {
      const Eigen::Vector3d d = p.cast<double>();
      cloud.points.push_back(d.cwiseProduct(radii).cast<float>());
      cloud.normals.push_back(d.cwiseQuotient(radii).normalized().cast<float>());
    }
    SplitParameters p;
    p.bodies.radius_min = 0.020, p.bodies.radius_max = 0.050;
    return split(cloud, p).found.size();
  };
  CHECK(found({0.060, 0.055, 0.050}) == 1);
  CHECK(found({0.080, 0.057, 0.044}) == 0);  // harmonic mean 57 mm, arithmetic mean 60 mm; the limit is 57.5 mm
}

TEST_CASE("the split follows a rigid motion of the cloud") {
  Cloud cloud;
  test::add_sphere(
      cloud, {{0, 0.5, 0.2}, 0.035}, 0.0025, [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.0; }, 0.0003);
  test::add_sphere(
      cloud, {{0.066, 0.5, 0.2}, 0.033}, 0.0025, [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.0; }, 0.0003);
  const Pose motion = pose_from_xyz_rpy({1.0, -2.0, 0.5}, {0.3, 0.2, -0.8});
  Cloud moved = cloud;
  for (auto& p : moved.points) p = (motion * p.cast<double>()).cast<float>();
  for (auto& n : moved.normals) n = (motion.linear() * n.cast<double>()).cast<float>();
  const Split a = split(cloud), b = split(moved);
  REQUIRE(a.found.size() == b.found.size());
  for (const FoundBody& f : a.found) {
    double best = 1.0;
    for (const FoundBody& g : b.found) best = std::min(best, (motion * f.fit.body.center - g.fit.body.center).norm());
    CHECK(best < 3e-4);
  }
}

TEST_CASE("each fruit of a whole tree is proposed") {
  std::vector<Sphere> fruit;
  Cloud cloud;
  for (int x = 0; x < 12; ++x)
    for (int z = 0; z < 10; ++z) {
      fruit.push_back({{0.07 * x, 1.0, 0.07 * z}, 0.03});
      test::add_sphere(cloud, fruit.back(), 0.003, [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.0; });
    }
  SplitParameters parameters;
  parameters.bodies.radius_min = 0.025;
  parameters.bodies.radius_max = 0.05;
  const Grid<float> grid(cloud, 0.006f);
  const auto stages = stages_for(estimate_spacing(cloud, grid), parameters);
  REQUIRE(stages);
  std::vector<BodyCandidate> candidates;
  detail::propose_voted(cloud, cloud, {}, grid, *stages, parameters, candidates);
  std::size_t proposed = 0;
  for (const Sphere& s : fruit)
    proposed += std::any_of(candidates.begin(), candidates.end(),
                            [&](const BodyCandidate& c) { return (c.body.center - s.center).norm() < 0.2 * s.radius; });
  CHECK(proposed == fruit.size());
}

TEST_CASE("too little to split is nothing") {
  Cloud cloud;
  CHECK(split(cloud).found.empty());
  cloud.points.emplace_back(0.0f, 0.0f, 0.0f);
  CHECK_THROWS_AS(split(cloud), InputError);  // no normals
  cloud.normals.emplace_back(0.0f, 0.0f, 1.0f);
  CHECK(split(cloud).labels == Labels{0});
  for (int i = 0; i < 500; ++i) {  // all equal
    cloud.points.push_back(cloud.points[0]);
    cloud.normals.push_back(cloud.normals[0]);
  }
  CHECK(split(cloud).found.empty());
  SplitParameters bad;
  bad.bodies.radius_min = -1.0;
  CHECK_THROWS_AS(split(cloud, bad), ParameterError);
}

TEST_CASE("bodies are tracked where a cloud has grown") {
  const Sphere old{{-0.05, 0.5, 0.2}, 0.03}, grown{{0.05, 0.5, 0.2}, 0.03};
  const auto front_of = [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.2; };
  Cloud before;
  test::add_sphere(before, old, 0.0025, front_of, 0.0003);
  const Split first = split(before);
  REQUIRE(first.found.size() == 1);
  Cloud after = before;
  test::add_sphere(after, grown, 0.0025, front_of, 0.0003);
  std::vector<char> fresh(after.size(), 0);

  const Split blind = track(after, first.found, {}, {}, fresh);
  REQUIRE(blind.found.size() == 1);  // nothing is said to be new
  CHECK(blind.found[0].fit.body.center == first.found[0].fit.body.center);

  std::fill(fresh.begin() + static_cast<std::ptrdiff_t>(before.size()), fresh.end(), char(1));
  const Split both = track(after, first.found, {}, {}, fresh);
  REQUIRE(both.found.size() == 2);
  const auto nearest = [&](const Eigen::Vector3d& c) {
    double best = 1.0;
    for (const FoundBody& b : both.found) best = std::min(best, (b.fit.body.center - c).norm());
    return best;
  };
  CHECK(nearest(first.found[0].fit.body.center) == 0.0);  // no new points: not fitted again
  CHECK(nearest(grown.center) < 0.001);
  CHECK(both.labels == track(after, both.found).labels);

  fresh.pop_back();
  CHECK_THROWS_AS(track(after, first.found, {}, {}, fresh), InputError);
}

TEST_CASE("masks propose bodies for what points leave, unless sight lines or points speak against these") {
  const Sphere seen{{0.0, 0.5, 0.3}, 0.035};
  const Eigen::Vector3d hidden(0.09, 0.5, 0.3);
  Cloud cloud;
  test::add_sphere(cloud, seen, 0.0025, [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.2; });
  MaskEvidence masks;
  masks.log_odds = [](const Ellipsoid&) { return 1.0; };
  masks.most = 4.0;
  std::size_t explained = 0;
  masks.remaining = [&](const std::vector<Ellipsoid>& known) {
    explained = known.size();
    MaskBody body;
    body.fit.body = Ellipsoid(agrisee::Sphere{hidden, 0.03});
    body.log_odds = 2.0;
    return std::vector<MaskBody>{body};
  };
  const Split with = split(cloud, {}, {{}, {}, masks});
  CHECK(explained == 1);
  REQUIRE(with.found.size() == 2);
  CHECK(with.found[0].found_by != "mask");
  CHECK(with.found[1].found_by == "mask");
  CHECK(with.found[1].by_mask);
  CHECK(with.found[1].confidence == Approx(1.0 / (1.0 + std::exp(-2.0))));
  const SeenThrough through = [&](const Ellipsoid& body) { return (body.center - hidden).norm() < 0.02 ? 0.3 : 0.0; };
  CHECK(split(cloud, {}, {through, {}, masks}).found.size() == 1);

  for (int i = -6; i <= 6; ++i)  // a leaf where the fruit's front would be
    for (int k = -6; k <= 6; ++k) {
      const Eigen::Vector3d across = front().unitOrthogonal(), along = front().cross(across);
      const Eigen::Vector3d p = hidden + 0.03 * front() + 0.002 * (i * across + k * along);
      cloud.points.push_back(p.cast<float>());
      cloud.normals.push_back(front().cast<float>());
    }
  CHECK(split(cloud, {}, {{}, {}, masks}).found.size() == 1);
}

TEST_CASE("masks change how far a body of points is believed") {
  Cloud cloud;
  test::add_sphere(cloud, {{0.0, 0.5, 0.3}, 0.035}, 0.0025,
                   [](const Eigen::Vector3d& d) { return d.dot(front()) > 0.5; });
  const auto confidence = [&](double odds) {
    MaskEvidence masks;
    masks.log_odds = [odds](const Ellipsoid&) { return odds; };
    masks.most = 4.0;
    SplitParameters parameters;
    parameters.bodies.min_confidence = 0.0;
    const Split found = split(cloud, parameters, {{}, {}, masks});
    return found.found.empty() ? 0.0 : found.found.front().confidence;
  };
  const double alone = confidence(0.0);
  REQUIRE(alone > 0.5);
  const double odds = std::log(alone / (1.0 - alone));
  CHECK(confidence(-3.0) == Approx(1.0 / (1.0 + std::exp(3.0 - odds))).epsilon(1e-6));
  CHECK(confidence(2.0) > alone);
}

namespace {

/// An ellipsoid of revolution, `ratio` times as long as wide (m).
Ellipsoid long_body(const Eigen::Vector3d& rpy, double radius, double ratio) {
  const Eigen::Matrix3d axes = pose_from_xyz_rpy({0, 0, 0}, rpy).linear();
  Ellipsoid body;
  body.center = {0.1, 0.5, 0.3};
  body.A = axes * Eigen::Vector3d(radius, radius, ratio * radius).cwiseInverse().asDiagonal() * axes.transpose();
  return body;
}

/// Points with normals of a body's surface, where the normals point to the front by at least a cosine.
Cloud surface_of(const Ellipsoid& body, int count, double least) {
  Cloud cloud;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d u = spiral_direction(i, count), n = (body.A * u).normalized();
    if (n.dot(front()) < least) continue;
    cloud.points.push_back((body.center + body.A.inverse() * u).cast<float>());
    cloud.normals.push_back(n.cast<float>());
  }
  return cloud;
}

}  // namespace

TEST_CASE("points at the tips of a long body get its label") {
  for (const double ratio : {1.0, 1.5, 2.0, 3.0}) {
    INFO("ratio " << ratio);
    FoundBody body;
    body.fit.body = long_body({0.4, -0.7, 1.1}, 0.02, ratio);
    const Cloud cloud = surface_of(body.fit.body, 6000, -1.1);
    const auto own = [](const Labels& labels) { return std::count(labels.begin(), labels.end(), 1); };
    CHECK(own(assign_to_bodies(cloud, {body})) == 6000);
    SplitParameters alone;  // its size is not known from others
    alone.bodies.alike = 0.0;
    const Split found = split(cloud, alone);
    REQUIRE(found.found.size() == 1);
    CHECK(own(found.labels) == 6000);
    CHECK((semi_axes(found.found[0].fit.body).first - Eigen::Vector3d(ratio * 0.02, 0.02, 0.02)).norm() < 0.001);
  }
}

TEST_CASE("a long body of which one side is seen is as deep as it is wide") {
  for (const double ratio : {2.0, 3.0}) {
    INFO("ratio " << ratio);
    const Ellipsoid body = long_body({0.0, 1.2, 0.2}, 0.018, ratio);
    const Cloud cloud = surface_of(body, 2000, 0.2);
    Split found;  // a body that is deeper
    found.found.resize(1);
    found.found[0].fit.body.center = body.center - 0.1 * 0.018 * front();
    found.found[0].fit.body.A = body.A - 0.15 / 0.018 * front() * front().transpose();
    found.labels.assign(cloud.size(), 1);
    const BodyParameters bodies;
    detail::refit(cloud, Grid<float>(cloud, static_cast<float>(bodies.cell())), bodies, found.found, found.labels);
    CHECK((found.found[0].fit.body.center - body.center).norm() < 0.001);
    CHECK((semi_axes(found.found[0].fit.body).first - Eigen::Vector3d(ratio * 0.018, 0.018, 0.018)).norm() < 0.001);
  }
}
