// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/growth_axis.hpp>
#include <agrisee/core/random.hpp>

#include <algorithm>

#include "catch.hpp"
#include "spheres.hpp"

using namespace agrisee;

namespace {

GrowthAxis axis_of(const Cloud& cloud, const Labels& labels, const EllipsoidFit& fit) {
  return growth_axis(stem_direction(cloud, labels, fit.body), body_axes(fit));
}

}  // namespace

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
  CHECK(std::acos(axis_of(cloud, labels, ball).direction.dot(up)) < deg(10));
  CHECK(axis_of(Cloud{}, {}, ball).direction.z() == Approx(1.0));  // nothing but gravity
  CHECK(axis_of(Cloud{}, {}, ball).variance > 2.0 * axis_of(cloud, labels, ball).variance);
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
    const auto axes = body_axes(*fit);
    REQUIRE(axes.size() == 3);
    const BodyAxis round = *std::min_element(
        axes.begin(), axes.end(), [](const BodyAxis& a, const BodyAxis& b) { return a.ovality < b.ovality; });
    const double off = std::acos(std::min(std::abs(round.direction.dot(axis)), 1.0));
    CHECK(off < deg(4));
    CHECK(off < 4.0 * std::sqrt(round.variance));
    CHECK(round.variance < deg(12) * deg(12));
    const Labels all(cloud.size(), 1);
    CHECK(std::acos(axis_of(cloud, all, *fit).direction.dot(axis)) < deg(6));
    // Stem points at the wrong place, some 50 degrees off, turn it by a few degrees only.
    Cloud more = cloud;
    Labels labels = all;
    const Eigen::Vector3d wrong = (axis + 1.2 * axis.unitOrthogonal()).normalized();
    for (int i = 0; i < 40; ++i) {
      more.points.push_back((truth.center + (truth.surface(wrong) - truth.center) * (1.02 + 0.01 * i)).cast<float>());
      labels.push_back(0);
    }
    CHECK(std::acos(axis_of(more, labels, *fit).direction.dot(axis)) < deg(15));
  }
  // A sphere has no such axis.
  EllipsoidFit ball;
  ball.body = Ellipsoid{Sphere{{0, 0, 0}, 0.03}};
  CHECK(body_axes(ball).empty());
}

TEST_CASE("the axes of a body, their variances and ovalities by hand") {
  EllipsoidFit fit;
  for (int k = 0; k < 6; ++k) fit.shape_covariance(k, k) = k < 5 ? k + 1.0 : 20.0;  // of xx, yy, zz, xy, xz, yz
  // The axis along x, y or z of a body with these inverse semi-axes.
  const auto axis = [&](int along, double x, double y, double z) {
    fit.body.A = Eigen::Vector3d(x, y, z).asDiagonal();
    for (const BodyAxis& a : body_axes(fit))
      if (std::abs(a.direction[along]) > 0.999) return a;
    return BodyAxis();
  };
  // Towards x the variance of xz counts, towards y that of yz, over the squared difference.
  CHECK(axis(2, 30, 32, 40).variance == Approx(std::max(5.0 / 100.0, 20.0 / 64.0)));
  CHECK(axis(0, 20, 30, 35).variance == Approx(std::max(4.0 / 100.0, 5.0 / 225.0)));
  // Those across z differ by 2 of 31; fruit by 5 %, and the fit by the variances of xx and yy.
  CHECK(axis(2, 30, 32, 40).ovality == Approx(2.0 / 31.0 / std::sqrt(0.0025 + 3.0 / (31.0 * 31.0))));
  CHECK(axis(0, 30, 32, 40).ovality == Approx(8.0 / 36.0 / std::sqrt(0.0025 + 5.0 / (36.0 * 36.0))));
  CHECK(body_axes(fit).size() == 3);
  fit.body.A = Eigen::Vector3d(30, 30, 30).asDiagonal();
  CHECK(body_axes(fit).empty());  // a sphere
  fit.body.A = Eigen::Vector3d(30, 32, 40).asDiagonal();
  fit.shape_covariance.setZero();
  CHECK(body_axes(fit).empty());  // not measured
  // Turned by 45 degrees about z, an oblong body has its axis between x and y; (xx - yy) / 2 tilts it.
  fit.shape_covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  fit.body.A << 25, -5, 0, -5, 25, 0, 0, 0, 31;  // 20 along (1, 1), 30 and 31 across
  const BodyAxis turned = body_axes(fit)[0];
  CHECK(std::abs(turned.direction.dot(Eigen::Vector3d(1, 1, 0))) == Approx(std::sqrt(2.0)));
  CHECK(turned.variance == Approx(std::max((1.0 + 2.0) / 4.0 / 100.0, (5.0 + 6.0) / 2.0 / 121.0)));
}

TEST_CASE("of a slightly oval fruit the axis nearest to the stem is the growth axis") {
  EllipsoidFit fit;
  fit.shape_covariance.setIdentity();
  fit.body.A = Eigen::Vector3d(1.0 / 0.94, 1.0 / 1.06, 1.0 / 0.88).asDiagonal() * (1.0 / 0.03);  // y is the longest
  const std::vector<BodyAxis> axes = body_axes(fit);
  const Eigen::Vector3d stem = Eigen::Vector3d(0.3, 0.1, 1.0).normalized();
  const GrowthAxis sure = growth_axis(stem, axes);
  CHECK(sure.direction.z() > std::cos(deg(12)));
  // Without a stem the longest axis might be it: the direction is hardly known.
  const GrowthAxis unsure = growth_axis(0.2 * stem, axes);
  CHECK(unsure.variance > 3.0 * sure.variance);
  // A flat fruit that is round about its axis needs no stem.
  fit.body.A = Eigen::Vector3d(1.0, 1.0, 1.0 / 0.8).asDiagonal() * (1.0 / 0.03);
  const GrowthAxis flat = growth_axis(0.2 * Eigen::Vector3d(0.6, 0.0, 0.8), body_axes(fit));
  CHECK(flat.direction.z() > std::cos(deg(5)));
  CHECK(std::sqrt(flat.variance) < deg(8));
}

TEST_CASE("the variance of a growth axis by hand") {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double any = 0.5 * kPi * kPi - 2.0;
  CHECK(growth_axis(Eigen::Vector3d::Zero(), {}).variance == any);
  CHECK(growth_axis(0.8 * up, {}).variance == Approx(0.5));  // a quarter of the weight, in tenths
  BodyAxis round{up, 0.02, 0.0};                             // 5 in these units
  CHECK(growth_axis(0.8 * up, {round}).variance == Approx(0.1 / 5.2));
  CHECK(growth_axis(0.8 * Eigen::Vector3d::UnitX(), {round}).variance == Approx(0.1 / std::hypot(5.0, 0.2)));
  // Two axes, one of them half as likely: a third of a square radian is added.
  const BodyAxis other{Eigen::Vector3d::UnitX(), 0.02, std::sqrt(2.0 * std::log(2.0))};
  const double variance = 0.02 + 1.0 / 3.0;
  CHECK(growth_axis(Eigen::Vector3d::Zero(), {round, other}).variance == Approx(variance));
  round.ovality = 1e3;  // nothing is likely
  CHECK(growth_axis(Eigen::Vector3d::Zero(), {round}).variance == Approx(1.02));
}

TEST_CASE("the growth axis of a ball with one stem point, by hand") {
  const double r = 0.04;
  const Ellipsoid ball(Sphere{{0.1, 0.5, 0.2}, r});
  const auto axis = [&](const Eigen::Vector3d& at, int label = 0, const std::vector<BodyAxis>& round = {}) {
    Cloud cloud;
    cloud.points = {(ball.center + r * at).cast<float>(), {5.0f, 5.0f, 5.0f}};
    return growth_axis(stem_direction(cloud, {label, 0}, ball), round).direction;
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
  CHECK(near(axis({3, 0, 0}, 0, {round}), Eigen::Vector3d(-8.0, 0, 6.35).normalized()));
  round.direction = -round.direction;
  CHECK(near(axis({3, 0, 0}, 0, {round}), Eigen::Vector3d(-8.0, 0, 6.35).normalized()));
  round.variance = 1e-9;  // no axis is known so well: a hundred times
  CHECK(near(axis({3, 0, 0}, 0, {round}), Eigen::Vector3d(-80.0, 0, 60.35).normalized()));
  // Points farther than two radii from the center are no calyx, however wide the shell.
  Cloud stem;
  stem.points = {(ball.center + r * Eigen::Vector3d(1.95, 0, 0)).cast<float>()};
  GrowthAxisParameters wide;
  wide.shell = 1.9;
  CHECK(near(growth_axis(stem_direction(stem, {0}, ball, wide), {}).direction, pulled(0.1 * 0.25)));
  stem.points[0] = (ball.center + r * Eigen::Vector3d(2.05, 0, 0)).cast<float>();
  CHECK(near(growth_axis(stem_direction(stem, {0}, ball, wide), {}).direction, up));
  GrowthAxisParameters level;
  level.up_weight = 0.0;
  CHECK(growth_axis(stem_direction(Cloud(), {}, ball, level), {}).direction == up);  // nothing known: up
  round.direction = Eigen::Vector3d(0.8, 0, -0.6);
  CHECK(near(growth_axis(stem_direction(Cloud(), {}, ball, level), {round}).direction,
             Eigen::Vector3d(-0.8, 0, 0.6)));  // upwards
}

TEST_CASE("the stem that meets the tip of a long fruit tells where its calyx is") {
  for (const double ratio : {1.0, 2.0, 2.5, 3.0}) {
    INFO("ratio " << ratio);
    const Eigen::Vector3d radii(0.018, 0.018, ratio * 0.018);
    Ellipsoid body;
    body.A = radii.cwiseInverse().asDiagonal();
    Cloud cloud;
    for (int i = 0; i < 200; ++i) cloud.points.emplace_back(0.0f, 0.0f, static_cast<float>(-radii.z() - 2e-5 * i));
    const Eigen::Vector3d stem = stem_direction(cloud, Labels(cloud.size(), 0), body);
    CHECK(stem.z() < -0.5);  // below, against gravity
  }
}
