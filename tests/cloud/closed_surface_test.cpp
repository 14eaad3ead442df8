// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/closed_surface.hpp>
#include <agrisee/cloud/fit.hpp>
#include <agrisee/core/random.hpp>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// A body r(direction), m; its axis of symmetry is z.
using Radius = double (*)(const Eigen::Vector3d&);

double ball(const Eigen::Vector3d&) { return 0.03; }

double tomato(const Eigen::Vector3d& d) {
  return 1.0 / std::sqrt((d.x() * d.x() + d.y() * d.y()) / 12.25e-4 + d.z() * d.z() / 9e-4);
}

/// A pear with its neck at z > 0.
double pear(const Eigen::Vector3d& d) {
  const double s2 = 1.0 - d.z() * d.z(), across = 0.032 * (1.0 - 0.45 * d.z());
  return 1.0 / std::sqrt(s2 / (across * across) + d.z() * d.z() / (0.048 * 0.048));
}

/// A strawberry with its point at z < 0.
double strawberry(const Eigen::Vector3d& d) {
  const double s2 = 1.0 - d.z() * d.z(), across = 0.02 * (1.0 + 0.35 * d.z());
  return 1.0 / std::sqrt(s2 / (across * across) + d.z() * d.z() / (0.026 * 0.026));
}

double egg(const Eigen::Vector3d& d) { return 0.025 * (1.0 + 0.14 * d.z() + 0.1 * d.z() * d.z()); }

/// A block of superelliptic outline (Lame's curve with exponent 2.8) with four lobes.
double pepper(const Eigen::Vector3d& d) {
  const double s = std::hypot(d.x(), d.y()), s2 = 1.0 - d.z() * d.z();
  const double block = std::pow(std::pow(s / 0.04, 2.8) + std::pow(std::abs(d.z()) / 0.048, 2.8), -1.0 / 2.8);
  return block * (1.0 + 0.09 * std::sqrt(s2) * std::cos(4.0 * std::atan2(d.y(), d.x()) + 0.7));
}

/// Volume and its center, from a fine grid of directions.
std::pair<double, Eigen::Vector3d> truth(Radius radius) {
  double volume = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n, phi = 2.399963229728653 * i, q = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d d(q * std::cos(phi), q * std::sin(phi), z);
    const double r = radius(d);
    volume += r * r * r / 3.0;
    first += r * r * r * r / 4.0 * d;
  }
  return {volume * 4.0 * kPi / n, first / volume};
}

/// Where the tests put bodies: turned and off the origin.
Pose world_T_body() {
  Pose pose = Pose::Identity();
  pose.linear() = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.1, 0.5, 0.2);
  return pose;
}

/// Points with normals where the body's surface faces -y in world, to `beyond` (cosine) behind its edge.
Cloud seen(Radius radius, double beyond, double noise = 0.0002, std::size_t points = 1500) {
  Cloud cloud;
  Rng rng(3);
  const Pose pose = world_T_body();
  const auto at = [&](const Eigen::Vector3d& e) -> Eigen::Vector3d { return radius(e.normalized()) * e.normalized(); };
  while (cloud.size() < points) {
    const Eigen::Vector3d d = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    const Eigen::Vector3d u = d.unitOrthogonal(), v = d.cross(u);
    const double h = 1e-4;
    const Eigen::Vector3d n =
        pose.linear() * (at(d + h * u) - at(d - h * u)).cross(at(d + h * v) - at(d - h * v)).normalized();
    if (n.y() > beyond) continue;
    cloud.points.push_back((pose * at(d) + noise * rng.normal() * n).cast<float>());
    cloud.normals.push_back(n.cast<float>());
  }
  return cloud;
}

Indices range(std::size_t from, std::size_t to) {
  Indices out;
  for (std::size_t i = from; i < to; ++i) out.push_back(static_cast<Index>(i));
  return out;
}

/// The surface through all points of a cloud; the first guess of the axis is 20 degrees off.
std::optional<ClosedSurface> close(const Cloud& cloud, const IsFree& is_free = {}) {
  const auto sphere = sphere_from_normals(cloud, range(0, cloud.size()));
  REQUIRE(sphere);
  const auto fit = fit_ellipsoid(cloud, range(0, cloud.size()), Ellipsoid(*sphere));
  REQUIRE(fit);
  const Eigen::Vector3d guess =
      world_T_body().linear() * Eigen::AngleAxisd(deg(20), Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ();
  return closed_surface(cloud, range(0, cloud.size()), {}, fit->body, guess, {}, is_free);
}

}  // namespace

TEST_CASE("fruit that are no ellipsoids, seen from a bit more than one side: center and volume") {
  struct Case {
    Radius radius;
    int lobes;
  };
  for (const Case& c : {Case{pear, 0}, Case{strawberry, 0}, Case{pepper, 4}})
    for (const double beyond : {0.3, 0.6}) {
      CAPTURE(c.lobes, beyond);
      const auto [volume, center] = truth(c.radius);
      const auto surface = close(seen(c.radius, beyond));
      REQUIRE(surface);
      CHECK(surface->weight == 1.0);
      CHECK(surface->lobes == c.lobes);
      CHECK((surface->center - world_T_body() * center).norm() < 0.0006);
      CHECK(surface->volume == Approx(volume).epsilon(0.025));
      CHECK(std::abs(surface->axis.dot(world_T_body().linear().col(2))) > std::cos(deg(2)));
      CHECK(surface->rms < 0.0005);
      CHECK(surface->center_covariance.trace() > 0.0);
      CHECK(surface->center_covariance.trace() < 1e-6);
      CHECK(surface->volume_error < 0.05);
    }
}

TEST_CASE("a neck is found where most of the points outside the ellipsoid are together") {
  const Cloud bare = seen(ball, 1.0, 0.0002, 1000);
  const Ellipsoid body(Sphere{world_T_body().translation(), 0.03});
  CHECK_FALSE(detail::neck_of(bare, range(0, bare.size()), body));
  Cloud cloud = bare;
  const Eigen::Vector3d up = Eigen::Vector3d(0.2, -0.3, 1.0).normalized();
  const auto put_out = [&](const Eigen::Vector3d& towards, double least, double factor) {
    int moved = 0;
    for (Eigen::Vector3f& p : cloud.points) {
      const Eigen::Vector3d d = p.cast<double>() - body.center;
      if (d.normalized().dot(towards) < least) continue;
      p = (body.center + factor * d).cast<float>();
      ++moved;
    }
    return moved;
  };
  CHECK(put_out(up, 0.9, 1.15) > 30);
  CHECK(put_out(-up, 0.95, 1.2) > 10);  // fewer on the other side, as beside a leaf
  const auto neck = detail::neck_of(cloud, range(0, cloud.size()), body);
  REQUIRE(neck);
  CHECK(neck->dot(up) > std::cos(deg(5)));
  CHECK_FALSE(detail::neck_of(cloud, {}, body));
}

TEST_CASE("the ellipsoid stays where it explains the points") {
  for (const Radius radius : {ball, tomato}) {
    const auto [volume, center] = truth(radius);
    for (const double beyond : {0.0, 0.6}) {
      const auto surface = close(seen(radius, beyond));
      REQUIRE(surface);
      CHECK(surface->weight == 0.0);
      CHECK(surface->joined.empty());
      // and if it were asked, the surface would be right, too
      CHECK((surface->center - world_T_body() * center).norm() < 0.0006);
      CHECK(surface->volume == Approx(volume).epsilon(0.03));
    }
  }
}

TEST_CASE("a calyx that stands out of the top is not taken for the fruit's own top") {
  const auto [volume, center] = truth(pepper);
  Cloud cloud = seen(pepper, 0.4);
  const Pose pose = world_T_body();
  for (std::size_t i = 0; i < cloud.size(); ++i) {  // the cap rises from its rim to a stalk of 24 mm
    const Eigen::Vector3d q = pose.inverse() * cloud.points[i].cast<double>(), d = q.normalized();
    const double rim = std::cos(deg(40)), rise = (d.z() - rim) / (1.0 - rim);
    if (rise <= 0.0 || i % 3 == 0) continue;  // skin shows between the sepals
    cloud.points[i] = (pose * (q + (0.004 + 0.02 * rise * rise) * d)).cast<float>();
  }
  const auto surface = close(cloud);
  REQUIRE(surface);
  CHECK((surface->center - pose * center).norm() < 0.001);
  CHECK(surface->volume == Approx(volume).epsilon(0.05));
}

TEST_CASE("a leaf that lies on a fruit is not taken for a neck of it") {
  const auto [volume, center] = truth(pepper);
  const Cloud skin = seen(pepper, 0.0);
  const Pose pose = world_T_body();
  for (const double turn : {-50.0, 80.0}) {  // degrees about the axis from the side that is seen
    CAPTURE(turn);
    // A blade of 30 by 50 mm that touches the shoulder and goes on upwards, seen instead of the skin behind it.
    const Eigen::Vector3d out =
        Eigen::AngleAxisd(deg(turn), Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(0.0, -0.9, 0.3);
    const Eigen::Vector3d normal = out.normalized(), aside = normal.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d up = aside.cross(normal), foot = pepper(normal) * normal;
    Cloud cloud;
    for (std::size_t i = 0; i < skin.size(); ++i) {
      const Eigen::Vector3d q = pose.inverse() * skin.points[i].cast<double>() - foot;
      if (q.dot(up) > 0.0 && std::abs(q.dot(aside)) < 0.015 && q.dot(normal) > -0.025) continue;
      cloud.points.push_back(skin.points[i]);
      cloud.normals.push_back(skin.normals[i]);
    }
    const std::size_t blade = cloud.size();
    for (double a = -0.015; a < 0.015; a += 0.0025)
      for (double b = 0.0; b < 0.05; b += 0.0025) {
        cloud.points.push_back((pose * (foot + a * aside + b * up)).cast<float>());
        cloud.normals.push_back((pose.linear() * normal).cast<float>());
      }
    const auto surface = close(cloud);
    REQUIRE(surface);
    CHECK((surface->center - pose * center).norm() < 0.0015);
    CHECK(surface->volume == Approx(volume).epsilon(0.05));
    int far = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Eigen::Vector3d q = pose.inverse() * cloud.points[i].cast<double>();
      const bool other = std::binary_search(surface->left_out.begin(), surface->left_out.end(), static_cast<Index>(i));
      if (i < blade) CHECK_FALSE(other);
      if (q.norm() > 1.2 * pepper(q.normalized())) {
        ++far;
        CHECK(other);
      }
    }
    CHECK(far > 10);
  }
}

TEST_CASE("sight lines bound the side that was not seen") {
  struct Case {
    Radius radius;
    double beyond, top;  // cosine of the angle from the axis above which nothing was seen
  };
  const Pose pose = world_T_body();
  for (const Case& c : {Case{tomato, 0.4, 0.0}, Case{strawberry, 1.0, 0.5}}) {
    const auto [volume, center] = truth(c.radius);
    Cloud cloud = seen(c.radius, c.beyond);
    Indices below;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if ((pose.inverse() * cloud.points[i].cast<double>()).normalized().z() < c.top)
        below.push_back(static_cast<Index>(i));
    cloud = select(cloud, below);
    const auto unbounded = close(cloud), bounded = close(cloud, [&](const Eigen::Vector3d&p) {
                                           const Eigen::Vector3d q = pose.inverse() * p;
                                           return q.norm() > c.radius(q.normalized()) + 0.002;
                                         });
    REQUIRE(unbounded);
    REQUIRE(bounded);
    CHECK(unbounded->volume > 1.1 * volume);
    CHECK(bounded->volume == Approx(volume).epsilon(0.07));
    CHECK((bounded->center - pose * center).norm() < 0.5 * (unbounded->center - pose * center).norm());
    CHECK(bounded->center_covariance.trace() < unbounded->center_covariance.trace());
  }
}

TEST_CASE("a sepal that lies on a round fruit is no reason to give up the ellipsoid") {
  for (const Radius radius : {ball, tomato})
    for (const double off : {0.05, 0.1, 0.2}) {  // of the radius
      CAPTURE(off);
      Cloud cloud = seen(radius, 0.4);
      const Pose pose = world_T_body();
      const Eigen::Vector3d middle = Eigen::Vector3d(0.3, -0.7, 0.6).normalized();
      for (std::size_t i = 0; i < cloud.size(); ++i) {  // 20 degrees wide, and seen instead of the skin below
        const Eigen::Vector3d d = (cloud.points[i].cast<double>() - pose.translation());
        if ((pose.linear().transpose() * d).normalized().dot(middle) < std::cos(deg(10))) continue;
        cloud.points[i] = (pose.translation() + (1.0 + off) * d).cast<float>();
      }
      const auto surface = close(cloud);
      REQUIRE(surface);
      CHECK(surface->weight == 0.0);
      CHECK(surface->joined.empty());
    }
}

TEST_CASE("evidence: values far off cost little, and others what they cost without them") {
  constexpr Eigen::Index kValues = 200;
  detail::LinearModel model{Eigen::MatrixXd(2, kValues), Eigen::VectorXd(kValues),
                            Eigen::VectorXd::Constant(kValues, 0.01), Eigen::VectorXd::Ones(2)};
  Rng rng(5);
  for (Eigen::Index i = 0; i < kValues; ++i) {
    model.B.col(i) << 1.0, double(i) / kValues;
    model.y[i] = 0.3 + 0.2 * model.B(1, i) + 0.1 * std::clamp(rng.normal(), -2.5, 2.5);
  }
  const double clean = detail::robust_evidence(model);
  CHECK(clean == Approx(detail::linear_posterior(model).evidence));
  for (const Eigen::Index i : {20, 70, 110, 160}) model.y[i] += i < 100 ? 1.5 : -1.5;
  CHECK(detail::robust_evidence(model) > clean - 4 * (4.5 + std::log(6.0)));
  CHECK(detail::linear_posterior(model).evidence < clean - 200.0);
}

TEST_CASE("evidence for an ellipsoid: another size costs little, an uneven surface much") {
  const ClosedSurfaceParameters parameters;
  const detail::SurfaceModel model(0, parameters);
  const Ellipsoid body(Sphere{{0.1, 0.5, 0.2}, 0.03});
  const auto evidence = [&](auto&& radius) {  // of a body r(direction), m
    constexpr int kPoints = 2000;
    detail::SurfaceFit::Samples samples;
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d d = spiral_direction(i, kPoints);
      samples.points.push_back(body.center + radius(d) * d);
      samples.normals.push_back(d);
    }
    samples.own = kPoints;
    const detail::SurfaceFit fit(samples, {body, Eigen::Vector3d::UnitZ()}, model, parameters);
    return detail::ellipsoid_evidence(body, fit, fit.radial_bins(fit.weights()), 0.01, parameters.uneven);
  };
  const double even = evidence([](const Eigen::Vector3d&) { return 0.03; });
  CHECK(even - evidence([](const Eigen::Vector3d&) { return 0.03 * 1.01; }) < 2.0);
  CHECK(even - evidence([](const Eigen::Vector3d& d) { return 0.03 * (1.0 + 0.03 * d.x() * d.y()); }) > 10.0);
}

TEST_CASE("a closed surface: the covariance of positions inside is that of the body") {
  const auto surface = close(seen(egg, 2.0, 0.0));
  REQUIRE(surface);
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  const auto [volume, center] = truth(egg);
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n, phi = 2.399963229728653 * i, q = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d d(q * std::cos(phi), q * std::sin(phi), z);
    second += std::pow(egg(d), 5) / 5.0 * d * d.transpose() * 4.0 * kPi / n;
  }
  const Eigen::Matrix3d r = world_T_body().linear();
  const Eigen::Matrix3d expected = r * (second / volume - center * center.transpose()) * r.transpose();
  CHECK((surface->spread - expected).norm() < 0.01 * expected.norm());
}

TEST_CASE("points of no fruit on the surface are joined, others not") {
  Cloud cloud = seen(pear, 0.5, 0.0001);
  Cloud own, all;
  const Pose body_T_world = world_T_body().inverse();
  for (const bool neck : {false, true})
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const bool high = (body_T_world * cloud.points[i].cast<double>()).z() > 0.038;
      if (high != neck) continue;
      all.points.push_back(cloud.points[i]);
      all.normals.push_back(cloud.normals[i]);
      if (!neck) own.points.push_back(cloud.points[i]), own.normals.push_back(cloud.normals[i]);
    }
  const std::size_t tip = all.size();
  for (int i = 0; i < 50; ++i) {  // a leaf in front
    all.points.push_back(Eigen::Vector3f(0.1f + 0.001f * static_cast<float>(i), 0.455f, 0.2f));
    all.normals.push_back(-Eigen::Vector3f::UnitY());
  }
  REQUIRE(tip > own.size() + 20);
  const auto sphere = sphere_from_normals(own, range(0, own.size()));
  const auto fit = fit_ellipsoid(own, range(0, own.size()), Ellipsoid(*sphere));
  REQUIRE(fit);
  const auto surface = closed_surface(all, range(0, own.size()), range(own.size(), all.size()), fit->body,
                                      world_T_body().linear().col(2));
  REQUIRE(surface);
  CHECK(surface->joined.size() > (tip - own.size()) * 2 / 3);
  CHECK(std::all_of(surface->joined.begin(), surface->joined.end(), [&](Index i) {
    return static_cast<std::size_t>(i) >= own.size() && static_cast<std::size_t>(i) < tip;
  }));
}

TEST_CASE("no closed surface of too few points; bad input is refused") {
  const Cloud cloud = seen(egg, 0.0, 0.0, 200);
  const Ellipsoid body(Sphere{world_T_body().translation(), 0.025});
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  CHECK_FALSE(closed_surface(cloud, {}, {}, body, up));
  CHECK_FALSE(closed_surface(cloud, range(0, 20), {}, body, up));
  Cloud flat = cloud;  // all in one direction
  for (auto& p : flat.points) p = Eigen::Vector3f(0.1f, 0.47f, 0.2f);
  CHECK_FALSE(closed_surface(flat, range(0, flat.size()), {}, body, up));
  Cloud bare;
  bare.points = cloud.points;
  CHECK_THROWS_AS(closed_surface(bare, range(0, bare.size()), {}, body, up), InputError);
  ClosedSurfaceParameters bad;
  bad.certain = bad.doubtful;
  CHECK_THROWS_AS(closed_surface(cloud, range(0, cloud.size()), {}, body, up, bad), ParameterError);
}

TEST_CASE("evidence lets the axis shift and tilt as far as a step may, no farther") {
  const Cloud cloud = seen(pear, 0.4);
  detail::SurfaceFit::Samples samples;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    samples.points.push_back(cloud.points[i].cast<double>());
    samples.normals.push_back(cloud.normals[i].cast<double>());
  }
  samples.own = cloud.size();
  const ClosedSurfaceParameters parameters;
  const detail::SurfaceModel model(0, parameters);
  const Pose pose = world_T_body();
  const detail::SurfaceFit fit(samples, {Ellipsoid(Sphere{pose.translation(), 0.035}), pose.linear().col(2)}, model,
                               parameters);
  const auto bins = fit.radial_bins(fit.weights());
  const detail::LinearModel once = fit.problem(model, bins, 0.02, 1.0), twice = fit.problem(model, bins, 0.02, 2.0);
  CHECK((once.prior.tail<4>() - Eigen::Vector4d(0.04, 0.04, 0.09, 0.09)).norm() < 1e-12);  // 0.2 radii, 0.3 rad
  CHECK((twice.prior.tail<4>() - 4.0 * once.prior.tail<4>()).norm() < 1e-12);
  CHECK(once.prior.head(once.prior.size() - 4) == twice.prior.head(once.prior.size() - 4));
  CHECK(fit.evidence(model, bins, 0.02) == Approx(detail::robust_evidence(once)).epsilon(1e-12));
  CHECK(fit.evidence(model, bins, 0.02) != Approx(detail::robust_evidence(twice)).epsilon(1e-6));
}

TEST_CASE("the frame of a closed surface is a turn that takes its axis to z") {
  const ClosedSurfaceParameters parameters;
  const detail::SurfaceModel model(0, parameters);
  const detail::SurfaceFit::Samples none;
  using Eigen::Vector3d;
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 2, 0), Vector3d(0, 0, -1), Vector3d(1, 2, 3)}) {
    const detail::SurfaceFit fit(none, {Ellipsoid(Sphere{{0.1, 0.5, 0.2}, 0.03}), axis}, model, parameters);
    CHECK((fit.turn() * axis.normalized() - Vector3d::UnitZ()).norm() < 1e-12);
    CHECK((fit.turn() * fit.turn().transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12);
    CHECK(fit.turn().determinant() == Approx(1.0));
  }
}

TEST_CASE("bins of a ball lie at its radius, and what is no fruit's does not count in the misfit") {
  constexpr int kPoints = 1000;
  const Ellipsoid body(Sphere{{0.1, 0.5, 0.2}, 0.03});
  detail::SurfaceFit::Samples samples;
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d d = spiral_direction(i, kPoints);
    samples.points.push_back(body.center + 0.03 * d);
    samples.normals.push_back(d);
  }
  samples.own = kPoints;
  samples.points.push_back(body.center + Eigen::Vector3d(0, 0, 0.06));  // a leaf above it
  samples.normals.push_back(Eigen::Vector3d::UnitZ());
  const ClosedSurfaceParameters parameters;
  const detail::SurfaceModel model(0, parameters);
  detail::SurfaceFit fit(samples, {body, Eigen::Vector3d::UnitX()}, model, parameters);
  const auto bins = fit.radial_bins(fit.weights());
  CHECK(bins.size() > 300);
  for (const detail::RadialBin& bin : bins) {
    CHECK(bin.logarithm == Approx(std::log(0.03)).epsilon(1e-9));
    CHECK(bin.direction.norm() == Approx(1.0));
  }
  REQUIRE(fit.step(model, {0.15, 0.15, false, false}));
  CHECK(fit.residuals().back() == Approx(std::log(2.0)).epsilon(1e-3));
  CHECK(fit.misfit() < 1e-6);
}
