// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/poses.hpp>
#include <agrisee/core/random.hpp>

#include <numeric>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

TEST_CASE("centroid and deviation by hand") {
  Cloud cloud;
  cloud.points = {{1, 2, 3}, {3, 2, 1}, {100, 100, 100}};
  const Centroid c = centroid(cloud, {0, 1});
  CHECK((c.mean - Eigen::Vector3d(2, 2, 2)).norm() < 1e-12);
  CHECK((c.sigma - Eigen::Vector3d(1, 0, 1)).norm() < 1e-12);
  CHECK(centroid(cloud, {}).mean.norm() == 0.0);
}

TEST_CASE("the highest point is the first of equally high ones") {
  Cloud cloud;
  CHECK(highest_point(cloud) == -1);
  cloud.points = {{0, 0, 3}, {1, 0, 1}, {2, 0, 3}};
  CHECK(highest_point(cloud) == 0);
  cloud.points[0].x() = std::nanf("");
  CHECK(highest_point(cloud) == 2);
}

TEST_CASE("the paper's pose frame looks at the highest point of the cloud") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0, 0}, 0.03}, 0.004, test::everywhere);
  cloud.normals.clear();
  Indices fruit(cloud.size());
  std::iota(fruit.begin(), fruit.end(), 0);
  cloud.points.emplace_back(0.1f, 0.0f, 0.5f);
  cloud.points.emplace_back(0.0f, -0.0301f, 0.0f);  // a dense spot at -y
  for (int i = 0; i < 30; ++i) {
    fruit.push_back(static_cast<Index>(cloud.size()));
    cloud.points.emplace_back(0.0f, -0.03f - 1e-5f * static_cast<float>(i), 0.0f);
  }
  const Eigen::Matrix3d frame = paper_pose_frame(cloud, fruit, Eigen::Vector3d::Zero());
  CHECK((frame.col(2) - Eigen::Vector3d(0.1, 0, 0.5).normalized()).norm() < 1e-6);
  CHECK(frame.col(0).y() < -0.95);
  CHECK(frame.determinant() == Approx(1.0));
  // Nothing to go by: still a frame.
  CHECK(frame_from_z_and_x(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()).determinant() == Approx(1.0));
}

TEST_CASE("the growth axis points to the stem that meets the fruit") {
  Cloud cloud;
  test::add_sphere(cloud, {{0, 0, 0}, 0.03}, 0.003, test::everywhere);
  Labels labels(cloud.size(), 1);
  const Eigen::Vector3d up = Eigen::Vector3d(0.5, 0.2, 1.0).normalized();
  for (int i = 0; i < 40; ++i) {
    cloud.points.push_back(((0.031 + 0.0004 * i) * up).cast<float>());
    labels.push_back(0);
  }
  EllipsoidFit ball;
  ball.body = Ellipsoid{Sphere{{0, 0, 0}, 0.03}};
  CHECK(std::acos(growth_axis(cloud, labels, ball).dot(up)) < deg(10));
  CHECK(growth_axis(Cloud{}, {}, ball).z() == Approx(1.0));  // nothing but gravity
}

TEST_CASE("the growth axis is the one about which the body is round") {
  const Eigen::Vector3d axis = Eigen::Vector3d(0.4, -0.5, 1.0).normalized();
  for (const double polar : {0.85, 1.4}) {  // flat, and oblong
    INFO("polar semi-axis " << polar);
    const Eigen::Matrix3d along = axis * axis.transpose();
    const Eigen::Matrix3d A = (Eigen::Matrix3d::Identity() - along + along / polar) / 0.03;
    Ellipsoid truth{Sphere{{0.1, 0.5, 0.2}, 0.03}};
    truth.A = A;
    Cloud cloud;
    Rng rng(4);
    Indices indices;
    while (cloud.size() < 1500) {
      const Eigen::Vector3d p = truth.surface(rng.direction()), n = truth.normal(p);
      if (n.y() > 0.3) continue;  // unseen from behind
      indices.push_back(static_cast<Index>(cloud.size()));
      cloud.points.push_back((p + 0.0003 * rng.normal() * n).cast<float>());
      cloud.normals.push_back(n.cast<float>());
    }
    const auto fit = fit_ellipsoid(cloud, indices, Ellipsoid{Sphere{{0.1, 0.5, 0.2}, 0.031}});
    REQUIRE(fit);
    const BodyAxis round = symmetry_axis(*fit);
    const double off = std::acos(std::min(std::abs(round.direction.dot(axis)), 1.0));
    CHECK(off < deg(4));
    CHECK(off < 4.0 * std::sqrt(round.variance));
    CHECK(round.variance < deg(12) * deg(12));
    const Labels all(cloud.size(), 1);
    CHECK(std::acos(growth_axis(cloud, all, *fit).dot(axis)) < deg(6));
    // Stem points at the wrong place, some 50 degrees off, turn it by a few degrees only.
    Cloud more = cloud;
    Labels labels = all;
    const Eigen::Vector3d wrong = (axis + 1.2 * axis.unitOrthogonal()).normalized();
    for (int i = 0; i < 40; ++i) {
      more.points.push_back((truth.center + (truth.surface(wrong) - truth.center) * (1.02 + 0.01 * i)).cast<float>());
      labels.push_back(0);
    }
    CHECK(std::acos(growth_axis(more, labels, *fit).dot(axis)) < deg(15));
  }
  // A sphere has no such axis.
  EllipsoidFit ball;
  ball.body = Ellipsoid{Sphere{{0, 0, 0}, 0.03}};
  CHECK(!std::isfinite(symmetry_axis(ball).variance));
}

TEST_CASE("the densest point is the first of those with most others near, wherever it is") {
  Cloud cloud;
  cloud.points = {{9, 9, 9}, {5, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 1, 0}, {7, 7, 7}, {5.5f, 0, 0}};
  const auto densest = [&](const Indices& indices, double radius) {
    return Eigen::Vector3d(densest_point(cloud, indices, radius));
  };
  CHECK(densest({1, 2, 3, 4, 5, 6}, 1.0) == Eigen::Vector3d(0, 0, 0));  // two within a metre; of the others one
  CHECK(densest({1, 3, 5, 6}, 1.0) == Eigen::Vector3d(5, 0, 0));        // the first of two
  CHECK(densest({5, 3, 1, 6}, 1.0) == Eigen::Vector3d(5, 1, 0));
  CHECK(densest({7, 1, 3, 5, 6}, 1.0) == Eigen::Vector3d(5, 0, 0));
  CHECK(densest({6, 2, 3}, 0.5) == Eigen::Vector3d(7, 7, 7));  // each alone: the first
  CHECK(densest({6}, 1.0) == Eigen::Vector3d(7, 7, 7));
  CHECK(densest({}, 1.0) == Eigen::Vector3d(0, 0, 0));
}

TEST_CASE("frames by hand") {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d expected;
  expected << y, -x, z;
  CHECK((frame_from_z_and_x({0, 0, 2}, {0, 3, 5}) - expected).norm() < 1e-12);
  expected << z, x, y;
  CHECK((frame_from_z_and_x(1e-9 * y, {0, -7, 1e-3}) - expected).norm() < 1e-9);  // short, but a direction
  const Eigen::Matrix3d up = frame_from_z_and_x(1e-13 * y, x);                    // too short: up
  CHECK((up - Eigen::Matrix3d::Identity()).norm() < 1e-12);
  const Eigen::Matrix3d free = frame_from_z_and_x(y, {0, 4, 0});  // the hint says nothing
  CHECK((free.col(2) - y).norm() < 1e-12);
  CHECK((free.transpose() * free - Eigen::Matrix3d::Identity()).norm() < 1e-12);
  CHECK(free.determinant() == Approx(1.0));
}

TEST_CASE("the paper's pose frame without a highest point has z up") {
  Cloud cloud;
  cloud.points = {{0, std::nanf(""), 0}};
  const Eigen::Matrix3d frame = paper_pose_frame(cloud, {}, Eigen::Vector3d(-1, 0, 3));
  CHECK((frame - Eigen::Matrix3d::Identity()).norm() < 1e-12);  // x away from the mean, level
}

TEST_CASE("the centroid of points far from the origin loses no digits") {
  PointCloud<double> cloud;
  const Eigen::Vector3d far(1e6, -2e6, 3e6);
  for (const double x : {-3e-3, 1e-3, 1e-3, 1e-3}) cloud.points.push_back(far + Eigen::Vector3d(x, 2 * x, 0));
  const Centroid c = centroid(cloud, {3, 0, 1, 2});
  CHECK((c.mean - far).norm() < 2e-9);
  CHECK(c.sigma.x() == Approx(std::sqrt(3.0) * 1e-3).epsilon(1e-5));
  CHECK(c.sigma.y() == Approx(std::sqrt(12.0) * 1e-3).epsilon(1e-5));
  CHECK(c.sigma.z() == 0.0);
  CHECK(centroid(cloud, {2}).sigma.norm() == 0.0);
}

TEST_CASE("the symmetry axis and its variance by hand") {
  EllipsoidFit fit;
  for (int k = 0; k < 6; ++k) fit.shape_covariance(k, k) = k < 5 ? k + 1.0 : 20.0;  // of xx, yy, zz, xy, xz, yz
  const auto axis = [&](double x, double y, double z) {
    fit.body.A = Eigen::Vector3d(x, y, z).asDiagonal();
    return symmetry_axis(fit);
  };
  // A flat body: z is short. Towards x the variance of xz counts, towards y that of yz, over the squared gap.
  CHECK(std::abs(axis(30, 30, 40).direction.z()) == Approx(1.0));
  CHECK(axis(30, 30, 40).variance == Approx(20.0 / 100.0));
  // An oblong one: x is long; xy and xz count.
  CHECK(std::abs(axis(20, 30, 30).direction.x()) == Approx(1.0));
  CHECK(axis(20, 30, 30).variance == Approx(5.0 / 100.0));
  // Three lengths: the other two differ by a quarter of what the axis does.
  CHECK(std::abs(axis(32, 30, 40).direction.z()) == Approx(1.0));
  CHECK(axis(32, 30, 40).variance == Approx(std::max(5.0 / 64.0, 20.0 / 100.0) + 1.0 / 16.0));
  CHECK(std::abs(axis(38, 40, 30).direction.z()) == Approx(1.0));
  CHECK(axis(38, 40, 30).variance == Approx(std::max(5.0 / 64.0, 20.0 / 100.0) + 1.0 / 16.0));
  CHECK(std::abs(axis(30, 40, 20).direction.y()) == Approx(1.0));  // equal gaps: the shortest
  CHECK(axis(30, 40, 20).variance == Approx(std::max(4.0 / 100.0, 20.0 / 400.0) + 1.0));
  CHECK_FALSE(std::isfinite(axis(30, 30, 30).variance));
  fit.shape_covariance.setZero();
  CHECK_FALSE(std::isfinite(axis(30, 30, 40).variance));  // not measured
  // Turned by 45 degrees about z, an oblong body has its axis between x and y; (xx - yy) / 2 tilts it.
  fit.shape_covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  fit.body.A << 25, -5, 0, -5, 25, 0, 0, 0, 30;  // 20 along (1, 1), 30 across
  const BodyAxis turned = symmetry_axis(fit);
  CHECK(std::abs(turned.direction.dot(Eigen::Vector3d(1, 1, 0))) == Approx(std::sqrt(2.0)));
  CHECK(turned.variance == Approx(std::max((1.0 + 2.0) / 4.0, (5.0 + 6.0) / 2.0) / 100.0));
}

TEST_CASE("the growth axis of a ball with one stem point, by hand") {
  const double r = 0.04;
  const Ellipsoid ball(Sphere{{0.1, 0.5, 0.2}, r});
  const auto axis = [&](const Eigen::Vector3d& at, int label = 0, const BodyAxis& round = {}) {
    Cloud cloud;
    cloud.points = {(ball.center + r * at).cast<float>(), {5.0f, 5.0f, 5.0f}};
    return growth_axis(cloud, {label, 0}, ball, round);
  };
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const auto near = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (a - b).norm() < 1e-5; };
  const auto pulled = [](double x) { return Eigen::Vector3d(x, 0.0, 0.35).normalized(); };
  // 0.15 radii above the surface, a third of the shell: its weight is (2 / 3)^2, of ten that would count fully.
  CHECK(near(axis({1.15, 0, 0}), pulled(4.0 / 90.0)));
  CHECK(near(axis({1.0, 0, 0}), pulled(0.1)));
  CHECK(near(axis({0.75, 0, 0}), pulled(0.1)));  // in a dimple
  CHECK(near(axis({0.69, 0, 0}), up));           // too deep
  CHECK(near(axis({1.46, 0, 0}), up));           // too far
  CHECK(near(axis({1.0, 0, 0}, 1), up));         // of a fruit
  CHECK(near(axis({0.6, 0, 0.8}), (Eigen::Vector3d(0, 0, 0.35) + 0.164 * Eigen::Vector3d(0.6, 0, 0.8)).normalized()));
  CHECK(near(axis({0.6, 0, -0.8}), (Eigen::Vector3d(0, 0, 0.35) + 0.036 * Eigen::Vector3d(0.6, 0, -0.8)).normalized()));
  // The body's axis, with a variance of 0.01 against 0.1 of the stem: ten times the weight, in the sense of the rest.
  BodyAxis round;
  round.variance = 0.01;
  round.direction = Eigen::Vector3d(0.8, 0, -0.6);
  CHECK(near(axis({3, 0, 0}, 0, round), Eigen::Vector3d(-8.0, 0, 6.35).normalized()));
  round.direction = -round.direction;
  CHECK(near(axis({3, 0, 0}, 0, round), Eigen::Vector3d(-8.0, 0, 6.35).normalized()));
  round.variance = 1e-9;  // no axis is known so well: a hundred times
  CHECK(near(axis({3, 0, 0}, 0, round), Eigen::Vector3d(-80.0, 0, 60.35).normalized()));
  // Points farther than two radii from the center are no calyx, however wide the shell.
  Cloud stem;
  stem.points = {(ball.center + r * Eigen::Vector3d(1.95, 0, 0)).cast<float>()};
  GrowthAxisParameters wide;
  wide.shell = 1.9;
  CHECK(near(growth_axis(stem, {0}, ball, BodyAxis(), wide), pulled(0.1 * 0.25)));
  stem.points[0] = (ball.center + r * Eigen::Vector3d(2.05, 0, 0)).cast<float>();
  CHECK(near(growth_axis(stem, {0}, ball, BodyAxis(), wide), up));
  GrowthAxisParameters level;
  level.up_weight = 0.0;
  CHECK(growth_axis(Cloud(), {}, ball, BodyAxis(), level) == up);  // nothing known: up
  round.direction = Eigen::Vector3d(0.8, 0, -0.6);
  CHECK(near(growth_axis(Cloud(), {}, ball, round, level), Eigen::Vector3d(-0.8, 0, 0.6)));  // upwards
}
