// SPDX-License-Identifier: BSD-3-Clause
// The parts of the fit of ellipsoids, and its covariances, against values worked out by hand.
#include <agrisee/cloud/fit.hpp>

#include <array>

#include "catch.hpp"
#include "cloud/cloud_cases.hpp"

using namespace agrisee;
using namespace agrisee::detail;
using cases::all_of;

namespace fit_test {

namespace {

using CloudD = PointCloud<double>;

constexpr double kRadius = 0.03;
const Eigen::Vector3d kCenter(0.1, 0.5, 0.2);

Ellipsoid ball(double radius = kRadius) { return Ellipsoid(Sphere{kCenter, radius}); }

/// Semi-axes of 40, 30 and 20 mm along x, y and z.
Ellipsoid egg() {
  Ellipsoid e;
  e.center = kCenter;
  e.A = Eigen::Vector3d(25.0, 100.0 / 3.0, 50.0).asDiagonal();
  return e;
}

/// An ellipsoid whose axes are not those of the frame.
Ellipsoid turned_egg() {
  Ellipsoid e = egg();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  e.A = turn * e.A * turn.transpose();
  return e;
}

/// The 24 directions to which the turns of a cube take one; mirrored: those to which turns and a mirror take it. Their
/// moments up to the third are those of the whole sphere: the mean of n n' is a third of the identity.
std::vector<Eigen::Vector3d> turns(const Eigen::Vector3d& d, bool mirrored) {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};  // even, then odd
  std::vector<Eigen::Vector3d> out;
  for (int order = 0; order < 6; ++order)
    for (int signs = 0; signs < 8; ++signs) {
      const Eigen::Vector3d s(signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1);
      if (((order < 3) == (s.prod() > 0.0)) == mirrored) continue;
      const int* o = kOrders[order];
      out.push_back(Eigen::Vector3d(s[0] * d[o[0]], s[1] * d[o[1]], s[2] * d[o[2]]).normalized());
    }
  return out;
}

const Eigen::Vector3d kFirst(1, 2, 4), kSecond(1, 3, 9);

void add(CloudD& cloud, const std::vector<Eigen::Vector3d>& directions, double distance) {
  for (const Eigen::Vector3d& n : directions) {
    cloud.points.push_back(kCenter + distance * n);
    cloud.normals.push_back(n);
  }
}

/// 48 points on the ball, and 48 that are as far from it, half of them inside.
CloudD half_off(double off) {
  CloudD cloud;
  for (const bool mirrored : {false, true}) add(cloud, turns(kFirst, mirrored), kRadius);
  add(cloud, turns(kSecond, false), kRadius + off);
  add(cloud, turns(kSecond, true), kRadius - off);
  return cloud;
}

/// Every point counts as one measurement.
FitParameters exact(double noise) {
  FitParameters p;
  p.noise = noise;
  p.independent = 400;
  return p;
}

/// Derivatives of the distance of a point of the ball by the center / radius and by radius * A.
Vector9 row_of(const Eigen::Vector3d& n) {
  Vector9 row;
  row << -n, n.x() * n.x(), n.y() * n.y(), n.z() * n.z(), 2 * n.x() * n.y(), 2 * n.x() * n.z(), 2 * n.y() * n.z();
  return kRadius * row;
}

double largest(const Eigen::MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("what was not measured is zero") {
  CHECK(Sphere().radius == 0.0);
  CHECK(SizePrior().radius == 0.0);
  CHECK(SizePrior().spread == 0.0);
  CHECK(EllipsoidFit().rms == 0.0);
  CHECK(EllipsoidFit().inliers == 0);
  CHECK(EllipsoidRow().residual == 0.0);
  CHECK(EllipsoidRow().weight == 0.0);
  CHECK(FitSums().weights == 0.0);
  CHECK(FitSums().squares == 0.0);
  CHECK(FitSums().inliers == 0);
}

TEST_CASE("lengths of an ellipsoid by hand") {
  const Ellipsoid e = egg();
  CHECK(e.mean_radius() == Approx(3.0 / (25.0 + 100.0 / 3.0 + 50.0)));  // harmonic
  CHECK(e.mean_semi_axis() == Approx(0.03));
  CHECK((e.surface(Eigen::Vector3d::UnitX()) - kCenter - Eigen::Vector3d(0.04, 0, 0)).norm() < 1e-12);
  CHECK((e.surface(-Eigen::Vector3d::UnitZ()) - kCenter + Eigen::Vector3d(0, 0, 0.02)).norm() < 1e-12);
  CHECK(e.distance(kCenter + Eigen::Vector3d(0.05, 0, 0)) == Approx(0.01));
  CHECK(e.distance(kCenter - Eigen::Vector3d(0, 0.027, 0)) == Approx(-0.003));
  CHECK((e.normal(kCenter - Eigen::Vector3d(0, 0.027, 0)) + Eigen::Vector3d::UnitY()).norm() < 1e-12);
  CHECK(e.distance(kCenter) == Approx(-e.mean_radius()));  // no direction is the nearest
  CHECK(e.normal(kCenter) == Eigen::Vector3d::UnitZ());
  CHECK(ball().distance(kCenter + Eigen::Vector3d(1e-9, 0, 0)) == Approx(-kRadius));
  CHECK((ball().normal(kCenter + Eigen::Vector3d(1e-9, 0, 0)) - Eigen::Vector3d::UnitX()).norm() < 1e-6);
  const Eigen::Vector3d v(1, -2, 3);
  CHECK((turned_egg().times(v) - turned_egg().A * v).norm() < 1e-9);
}

TEST_CASE("the foot of a point of an ellipsoid has the normal of the surface") {
  const Ellipsoid e = egg();
  for (const Eigen::Vector3d& d : turns(kFirst, false)) {
    const Eigen::Vector3d p = e.surface(d), q = p - kCenter;
    const Eigen::Vector3d gradient(q.x() / 16.0, q.y() / 9.0, q.z() / 4.0);
    CHECK(std::abs(e.distance(p)) < 1e-12);
    CHECK((e.normal(p) - gradient.normalized()).norm() < 1e-9);
    CHECK(ball().distance(kCenter + 0.05 * d) == Approx(0.05 - kRadius));
    CHECK(ball().distance(kCenter + 0.01 * d) == Approx(0.01 - kRadius));
  }
}

TEST_CASE("semi-axes are sorted, and their directions have signs by rule") {
  Ellipsoid e;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  e.A = turn * Eigen::Vector3d(50.0, 25.0, 100.0 / 3.0).asDiagonal() * turn.transpose();
  const auto [lengths, axes] = semi_axes(e);
  CHECK((lengths - Eigen::Vector3d(0.04, 0.03, 0.02)).norm() < 1e-12);
  CHECK((axes.col(0) + turn.col(1)).norm() < 1e-9);  // the largest entry of (-sin, cos) is negative: turned round
  CHECK((axes.col(1) - Eigen::Vector3d::UnitZ()).norm() < 1e-9);
  CHECK(std::abs(axes.col(2).dot(turn.col(0))) == Approx(1.0));
  for (const bool mirrored : {false, true})
    for (const Eigen::Vector3d& d : turns(kFirst, mirrored)) {
      const Eigen::Matrix3d round = Eigen::AngleAxisd(1.0 + d.x(), d).toRotationMatrix();
      e.A = round * egg().A * round.transpose();
      const Eigen::Matrix3d found = semi_axes(e).second;
      CHECK(found.determinant() == Approx(1.0));
      for (int a = 0; a < 2; ++a) CHECK(found.col(a).maxCoeff() == found.col(a).cwiseAbs().maxCoeff());
    }
}

TEST_CASE("a sphere follows from four points, from three or equal normals none") {
  CloudD cloud;
  add(cloud,
      {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitX(), Eigen::Vector3d(0, 0.6, 0.8)},
      kRadius);
  const auto sphere = sphere_from_normals(cloud, {0, 1, 2, 3});
  REQUIRE(sphere);
  CHECK((sphere->center - kCenter).norm() < 1e-12);
  CHECK(sphere->radius == Approx(kRadius));
  CHECK_FALSE(sphere_from_normals(cloud, {0, 1, 2}));
  for (auto& n : cloud.normals) n = -n;
  CHECK(sphere_from_normals(cloud, {0, 1, 2, 3})->radius == Approx(-kRadius));  // a hollow
  const auto narrow = [&](double angle) {  // normals that differ by the angle from their mean
    CloudD few;
    add(few,
        {Eigen::Vector3d(std::sin(angle), 0, std::cos(angle)), Eigen::Vector3d(-std::sin(angle), 0, std::cos(angle)),
         Eigen::Vector3d(0, std::sin(angle), std::cos(angle)), Eigen::Vector3d(0, -std::sin(angle), std::cos(angle))},
        kRadius);
    return sphere_from_normals(few, {0, 1, 2, 3}).has_value();
  };
  CHECK(narrow(0.0011));
  CHECK_FALSE(narrow(0.0009));
}

TEST_CASE("derivatives of a point's row are those of its distance") {
  const double size = 0.027, h = 1e-6;
  for (const Ellipsoid& body : {ball(), egg(), turned_egg()})
    for (const Eigen::Vector3d& d : turns(kFirst, false)) {
      const Eigen::Vector3d p = body.surface(d);
      const EllipsoidRow row = ellipsoid_row(body, p, body.normal(p), size, 0.005, 0.5);
      CHECK(std::abs(row.residual) < 1e-12);
      CHECK(row.weight == Approx(1.0));
      const auto slope = [&](auto&& change) {
        Ellipsoid more = body, less = body;
        change(more, h), change(less, -h);
        return (more.distance(p) - less.distance(p)) / (2.0 * h);
      };
      Vector9 expected;
      for (int a = 0; a < 3; ++a) {
        expected[a] = slope([&](Ellipsoid& e, double x) { e.center[a] += size * x; });
        expected[3 + a] = slope([&](Ellipsoid& e, double x) { e.A(a, a) += x / size; });
      }
      constexpr std::array<std::array<int, 2>, 3> kOff = {{{0, 1}, {0, 2}, {1, 2}}};
      for (int k = 0; k < 3; ++k)
        expected[6 + k] = slope([&](Ellipsoid& e, double x) {
          const int i = kOff[static_cast<std::size_t>(k)][0], j = kOff[static_cast<std::size_t>(k)][1];
          e.A(i, j) += x / size, e.A(j, i) += x / size;
        });
      CHECK(largest(row.derivatives - expected) < 1e-7 * size);
      // Off the surface they are those of the point's radial projection.
      const EllipsoidRow off =
          ellipsoid_row(body, body.center + 1.1 * (p - body.center), body.normal(p), size, 0.01, 0.5);
      CHECK(largest(off.derivatives - row.derivatives) < 1e-9 * size);
    }
}

TEST_CASE("the weight of a point falls to zero at the gate and where normals disagree") {
  const Ellipsoid body = egg();
  const auto row = [&](double x, double angle) {  // of a point on the longest axis
    const Eigen::Vector3d normal(std::cos(angle), 0, std::sin(angle));
    return ellipsoid_row(body, body.center + Eigen::Vector3d(x, 0, 0), normal, 0.03, 0.004, std::cos(deg(50)));
  };
  CHECK(row(0.042, 0.0).residual == Approx(0.002));
  CHECK(row(0.042, 0.0).weight == Approx(0.75 * 0.75));
  CHECK(row(0.037, 0.0).residual == Approx(-0.003));
  CHECK(row(0.037, 0.0).weight == Approx(49.0 / 256.0));
  CHECK(row(0.0441, 0.0).weight == 0.0);
  CHECK(row(0.0441, 0.0).residual == Approx(0.0041));
  CHECK(row(0.0359, 0.0).weight == 0.0);
  CHECK(row(0.04, deg(49)).weight == Approx(1.0));
  CHECK(row(0.04, deg(51)).weight == 0.0);
  CHECK(row(0.0, 0.0).weight == 0.0);  // at the center
  CHECK(row(0.0, 0.0).residual == 0.0);
}

TEST_CASE("the prior on the shape counts what differs from a sphere, relative to its size") {
  const double size = 0.02, spread = 0.04;
  Eigen::Matrix3d b;
  b << 0.3, 0.1, -0.2, 0.1, -0.1, 0.4, -0.2, 0.4, 0.7;
  Vector9 v = Vector9::Constant(5.0);  // the center does not matter
  v.tail<6>() << b(0, 0), b(1, 1), b(2, 2), b(0, 1), b(0, 2), b(1, 2);
  const Eigen::Matrix3d unlike = b - b.trace() / 3.0 * Eigen::Matrix3d::Identity();
  const double relative = size / kRadius;
  const Matrix9 prior = shape_information(ball(), size, spread);
  CHECK(v.dot(prior * v) == Approx(unlike.squaredNorm() / std::pow(spread * relative, 2)));
  CHECK(prior == prior.transpose());
  CHECK(size_row().dot(v) == Approx(b.trace() / 3.0));
  CHECK(size_information({0.03, 0.1}, 0.06) == Approx(std::pow(0.5 / 0.1, 2)));
}

TEST_CASE("samples are picked evenly, the first point first") {
  CloudD cloud;
  for (int i = 0; i < 12; ++i) {
    cloud.points.emplace_back(i, 0, 0);
    cloud.normals.emplace_back(0, i, 0);
  }
  const auto picked = [&](const Indices& indices, std::size_t used) {
    std::vector<double> out;
    for (const FitSample& s : fit_samples(cloud, indices, used)) {
      CHECK(s.normal.y() == s.point.x());
      out.push_back(s.point.x());
    }
    return out;
  };
  CHECK(picked({11, 1, 2, 3, 4, 5, 6, 7, 8, 9}, 4) == std::vector<double>{11, 2, 5, 7});
  CHECK(picked({3, 1, 2}, 3) == std::vector<double>{3, 1, 2});
}

TEST_CASE("sums over two points by hand") {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  const std::vector<FitSample> samples = {{kCenter + (kRadius + 0.001) * x, x},
                                          {kCenter + (kRadius - 0.002) * z, z},
                                          {kCenter + (kRadius + 0.009) * z, z},  // beyond the gate
                                          {kCenter + kRadius * z, -z}};          // its normal disagrees
  const FitSums sums = fit_sums<double>(samples, ball(), kRadius, 0.004, 0.5, 0.0015);
  const double near = std::pow(1.0 - 1.0 / 16.0, 2), far = std::pow(1.0 - 1.0 / 4.0, 2);
  CHECK(sums.weights == Approx(near + far));
  CHECK(sums.inliers == 1);
  CHECK(sums.squares == Approx(1e-6));
  const Vector9 a = row_of(x), c = row_of(z);
  CHECK(largest(sums.normal_matrix - (near * a * a.transpose() + far * c * c.transpose())) < 1e-15);
  CHECK(largest(sums.rhs + near * 0.001 * a - far * 0.002 * c) < 1e-15);
}

TEST_CASE("priors are added to the points' information") {
  FitSums sums;
  sums.normal_matrix.setIdentity();
  sums.rhs = Vector9::LinSpaced(1.0, 9.0);
  const Vector9 before = sums.rhs;
  const double size = 0.024;
  const SizePrior known{0.036, 0.1};
  add_prior(sums, ball(), size, 4.0, 0.04, known);
  // The ball is as round as the prior wants it, but of another size: 0.8 against 2 / 3 of the unit.
  const double information = std::pow(0.036 / (0.1 * size), 2);
  Vector9 rhs = 4.0 * before;
  rhs.segment<3>(3).array() -= information * (0.8 - 2.0 / 3.0) / 3.0;
  CHECK(largest(sums.rhs - rhs) < 1e-6);
  Matrix9 expected = 4.0 * Matrix9::Identity() + shape_information(ball(), size, 0.04);
  expected.block<3, 3>(3, 3).array() += information / 9.0;
  CHECK(largest(sums.normal_matrix - expected) < 1e-8 * largest(expected));
  CHECK(sums.normal_matrix(0, 0) > 4.0);  // a trace more, so that it can be solved whatever the points

  FitSums longer;  // a body of 0.6 units along x and 0.9 across, and skew
  longer.normal_matrix.setZero();
  longer.rhs.setZero();
  Ellipsoid oblong = ball();
  oblong.A << 0.6, 0.01, 0.02, 0.01, 0.9, 0.03, 0.02, 0.03, 0.9;
  oblong.A /= size;
  add_prior(longer, oblong, size, 1.0, 0.04);
  const double pull = 1.0 / std::pow(0.04 * 0.8, 2);
  rhs << 0, 0, 0, 0.2, -0.1, -0.1, -0.02, -0.04, -0.06;
  rhs *= pull;
  CHECK(largest(longer.rhs - rhs) < 1e-6 * pull);
}

TEST_CASE("a step moves the center and changes the shape; long ones are shortened") {
  const double size = 0.02;
  Vector9 step;
  step << 0.1, -0.2, 0.05, 0.1, 0.02, -0.03, 0.04, 0.05, -0.06;
  Ellipsoid body(Sphere{kCenter, size});
  auto longest = apply_step(body, step, size);
  REQUIRE(longest);
  CHECK(*longest == Approx(std::sqrt(0.01 + 0.04 + 0.0025)));
  CHECK((body.center - kCenter - size * Eigen::Vector3d(0.1, -0.2, 0.05)).norm() < 1e-15);
  Eigen::Matrix3d shape;
  shape << 1.1, 0.04, 0.05, 0.04, 1.02, -0.06, 0.05, -0.06, 0.97;
  CHECK(largest(body.A * size - shape) < 1e-12);

  step.setZero();
  step[0] = 0.1, step[8] = -0.6;
  body = Ellipsoid(Sphere{kCenter, size});
  longest = apply_step(body, step, size);
  REQUIRE(longest);
  CHECK(*longest == Approx(0.6));
  CHECK(body.center.x() == Approx(kCenter.x() + 0.05 * size));
  CHECK(body.A(1, 2) * size == Approx(-0.3));
  CHECK(body.A(2, 1) * size == Approx(-0.3));
}

TEST_CASE("a body that gets five times as large or as small in a direction is none") {
  const double size = 0.02;
  const auto grows = [&](double inverse, double by) {  // along z
    Ellipsoid body(Sphere{kCenter, size});
    body.A(2, 2) = inverse / size;
    Vector9 step = Vector9::Zero();
    step[5] = by;
    return apply_step(body, step, size).has_value();
  };
  CHECK(grows(0.4, -0.19));
  CHECK_FALSE(grows(0.4, -0.21));
  CHECK(grows(4.9, 0.09));
  CHECK_FALSE(grows(4.9, 0.11));
  CHECK_FALSE(grows(1.0, std::nan("")));
  Ellipsoid body(Sphere{kCenter, size});
  Vector9 step = Vector9::Zero();
  step[1] = std::nan("");
  CHECK_FALSE(apply_step(body, step, size));
}

TEST_CASE("of points all around a ball the covariances are those of the textbook") {
  CloudD cloud;
  for (const bool mirrored : {false, true}) add(cloud, turns(kFirst, mirrored), kRadius);
  const double noise = 0.001;
  const auto fit = fit_ellipsoid(cloud, all_of(cloud), ball(), exact(noise));
  REQUIRE(fit);
  CHECK((fit->body.center - kCenter).norm() < 1e-12);
  CHECK(fit->body.mean_radius() == Approx(kRadius));
  CHECK(fit->inliers == 48);
  CHECK(fit->rms < 1e-12);
  CHECK_FALSE(fit->size_prior);
  // A point measures the center along its normal: 48 of them, a third of which count in each direction.
  const Eigen::Matrix3d by_points = noise * noise / 16.0 * Eigen::Matrix3d::Identity();
  CHECK(largest(fit->center_covariance - by_points) < 1e-6 * by_points(0, 0));
  CHECK(largest(fit->center_covariance_by_shape) < 1e-6 * by_points(0, 0));  // nothing was left open
  // Of the shape, radius * A: sums of the fourth powers, and of the products of two squares.
  double fourth = 0.0, mixed = 0.0;
  for (const auto& n : cloud.normals) fourth += std::pow(n.x(), 4), mixed += n.x() * n.x() * n.y() * n.y();
  const double unit = kRadius * kRadius / (noise * noise), stiff = 1.0 / (0.04 * 0.04);
  const double even = 1.0 / (unit * (fourth + 2.0 * mixed)), uneven = 1.0 / (unit * (fourth - mixed) + stiff);
  Matrix6 shape = Matrix6::Zero();
  shape.topLeftCorner<3, 3>().setConstant((even - uneven) / 3.0);
  shape.diagonal().head<3>().setConstant((even + 2.0 * uneven) / 3.0);
  shape.diagonal().tail<3>().setConstant(1.0 / (4.0 * unit * mixed + 2.0 * stiff));
  shape /= kRadius * kRadius;
  CHECK(largest(fit->shape_covariance - shape) < 1e-6 * largest(shape));
}

TEST_CASE("of points on one side the shape's prior is part of the center's covariance") {
  CloudD cloud;
  for (const bool mirrored : {false, true})
    for (const Eigen::Vector3d& n : turns(kFirst, mirrored))
      if (n.y() < 0.0) add(cloud, {n}, kRadius);
  REQUIRE(cloud.size() == 24);
  const double noise = 0.001;
  FitParameters parameters = exact(noise);
  parameters.independent = 100;
  for (const bool sized : {false, true}) {
    const std::optional<SizePrior> size = sized ? std::optional<SizePrior>({kRadius, 0.1}) : std::nullopt;
    const auto fit = fit_ellipsoid(cloud, all_of(cloud), ball(), parameters, size);
    REQUIRE(fit);
    CHECK(fit->size_prior.has_value() == sized);
    Matrix9 points = Matrix9::Zero(), prior = Matrix9::Zero();
    for (const auto& n : cloud.normals) points += row_of(n) * row_of(n).transpose() / (noise * noise);
    for (int i = 3; i < 6; ++i) {
      prior(i + 3, i + 3) = 2.0 / (0.04 * 0.04);
      for (int j = 3; j < 6; ++j)
        prior(i, j) = ((i == j) - 1.0 / 3.0) / (0.04 * 0.04) + (sized ? 1.0 / (9.0 * 0.1 * 0.1) : 0.0);
    }
    const Matrix9 covariance = (points + prior).inverse();
    const Matrix9 by_prior = covariance * prior * covariance;
    const double unit = kRadius * kRadius;
    const Eigen::Matrix3d center = unit * covariance.topLeftCorner<3, 3>();
    const Eigen::Matrix3d by_shape = unit * by_prior.topLeftCorner<3, 3>();
    CHECK(largest(fit->center_covariance - center) < 1e-5 * largest(center));
    CHECK(largest(fit->center_covariance_by_shape - by_shape) < 1e-5 * largest(by_shape));
    CHECK(largest(fit->shape_covariance - covariance.bottomRightCorner<6, 6>() / unit) <
          1e-5 * largest(covariance.bottomRightCorner<6, 6>()) / unit);
    CHECK(by_shape(1, 1) > 0.1 * center(1, 1));  // along the line of sight
    CHECK(by_shape(0, 0) < 0.1 * by_shape(1, 1));
  }
}

TEST_CASE("points beyond the number of independent ones, and thinned ones, add what they should") {
  CloudD cloud;
  for (const bool mirrored : {false, true}) add(cloud, turns(kFirst, mirrored), kRadius);
  CloudD twice;
  for (std::size_t i = 0; i < 2 * cloud.size(); ++i) {
    twice.points.push_back(cloud.points[i / 2]);
    twice.normals.push_back(cloud.normals[i / 2]);
  }
  const double noise = 0.001;
  const auto variance = [&](const CloudD& of, int independent, int max_points, std::size_t inliers) {
    FitParameters parameters = exact(noise);
    parameters.independent = independent;
    parameters.max_points = max_points;
    const auto fit = fit_ellipsoid(of, all_of(of), ball(), parameters);
    REQUIRE(fit);
    CHECK(fit->inliers == inliers);
    return fit->center_covariance(0, 0) / (noise * noise);
  };
  CHECK(variance(cloud, 400, 400, 48) == Approx(3.0 / 48.0));
  CHECK(variance(cloud, 24, 400, 48) == Approx(3.0 / 24.0));
  CHECK(variance(twice, 400, 400, 96) == Approx(3.0 / 96.0));
  CHECK(variance(twice, 400, 48, 96) == Approx(3.0 / 96.0));  // each of those used stands for two
  CHECK(variance(twice, 60, 48, 96) == Approx(3.0 / 60.0));
  CHECK(variance(twice, 440, 10, 96) == Approx(3.0 / 96.0));  // no fewer are used than a fit needs, 48
}

TEST_CASE("the gate shrinks with each step, to a limit by the noise or by the size") {
  const auto check = [](double noise, double off, const std::vector<double>& gates, std::size_t inliers) {
    const CloudD cloud = half_off(off);
    for (std::size_t k = 0; k < gates.size(); ++k) {
      CAPTURE(noise, k);
      FitParameters parameters = exact(noise);
      parameters.iterations = static_cast<int>(k) + 1;
      const auto fit = fit_ellipsoid(cloud, all_of(cloud), ball(), parameters);
      REQUIRE(fit);
      const double t = off / gates[k], weight = t < 1.0 ? std::pow(1.0 - t * t, 2) : 0.0;
      CHECK(fit->center_covariance(0, 0) == Approx(3.0 * noise * noise / (48.0 + 48.0 * weight)).epsilon(1e-6));
      CHECK(fit->inliers == inliers);
      CHECK(fit->rms == Approx(inliers == 96 ? off / std::sqrt(2.0) : 0.0).margin(1e-12));
      CHECK((fit->body.center - kCenter).norm() < 1e-9);
    }
  };
  check(0.001, 0.0035, {0.006, 0.0042, 0.004, 0.004, 0.004, 0.004}, 48);
  check(0.001, 0.0025, {0.006, 0.0042, 0.004, 0.004, 0.004, 0.004}, 96);
  check(0.0002, 0.0012, {0.0036, 0.00252, 0.001764, 0.0015, 0.0015, 0.0015}, 48);
  check(0.0002, 0.0008, {0.0036, 0.00252, 0.001764, 0.0015, 0.0015, 0.0015}, 96);
}

TEST_CASE("a fit needs a tenth of the independent points and four, half of them on the body") {
  const auto directions = turns(kFirst, false), others = turns(kSecond, false);
  FitParameters parameters = exact(0.001);
  parameters.independent = 160;  // 20 points
  const auto fits = [&](std::size_t on, std::size_t off) {
    CloudD cloud;
    add(cloud, {directions.begin(), directions.begin() + static_cast<std::ptrdiff_t>(on)}, kRadius);
    add(cloud, {others.begin(), others.begin() + static_cast<std::ptrdiff_t>(off)}, 1.5 * kRadius);
    const auto fit = fit_ellipsoid(cloud, all_of(cloud), ball(), parameters);
    if (fit) CHECK(fit->inliers == on);
    return fit.has_value();
  };
  CHECK(fits(20, 0));
  CHECK_FALSE(fits(19, 0));
  CHECK(fits(10, 10));
  CHECK_FALSE(fits(9, 11));
  CHECK_FALSE(fits(0, 24));
  parameters.shape_prior = 0.0;
  CHECK_THROWS_AS(fits(20, 0), ParameterError);
}

TEST_CASE("points that hardly count make no body, nor do those of a plane") {
  CloudD cloud;
  add(cloud, turns(kFirst, false), kRadius + 0.0029);
  add(cloud, turns(kFirst, true), kRadius - 0.0029);
  FitParameters parameters = exact(0.001);
  parameters.independent = 360;  // 40 points, so weights of 12
  parameters.iterations = 2;     // the last gate is 4.2 mm: 48 weights of 0.27
  CHECK(fit_ellipsoid(cloud, all_of(cloud), ball(), parameters));
  parameters.iterations = 3;  // 4 mm: of 0.22
  CHECK_FALSE(fit_ellipsoid(cloud, all_of(cloud), ball(), parameters));

  CloudD plane;
  for (int i = 0; i < 400; ++i) {
    plane.points.push_back(kCenter + Eigen::Vector3d(0.002 * (i % 20) - 0.019, 0.002 * (i / 20) - 0.019, kRadius));
    plane.normals.push_back(Eigen::Vector3d::UnitZ());
  }
  CHECK_FALSE(fit_ellipsoid(plane, all_of(plane), ball()));
  parameters = {};
  for (parameters.iterations = 1; parameters.iterations < 12; ++parameters.iterations)  // however early it gives up
    if (const auto fit = fit_ellipsoid(plane, all_of(plane), ball(), parameters))
      CHECK(semi_axes(fit->body).first.maxCoeff() < 5.0 * kRadius);
}

TEST_CASE("noise is at most a share of the radius, and at least that of the sensor") {
  const CloudD cloud = half_off(0.0);
  const auto noise = [&](double usual, double most, double sensor) {
    FitParameters parameters = exact(usual);
    parameters.max_noise = most;
    parameters.sensor_noise = sensor;
    const auto fit = fit_ellipsoid(cloud, all_of(cloud), ball(), parameters);
    REQUIRE(fit);
    return std::sqrt(fit->center_covariance(2, 2) * 96.0 / 3.0);
  };
  CHECK(noise(0.001, 0.05, 0.0) == Approx(0.001));
  CHECK(noise(0.002, 0.05, 0.0) == Approx(0.0015));
  CHECK(noise(0.002, 0.05, 0.0018) == Approx(0.0018));
  CHECK(noise(0.002, 0.05, 0.0012) == Approx(0.0015));
}

}  // namespace fit_test
