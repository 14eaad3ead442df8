// SPDX-License-Identifier: BSD-3-Clause
// Fits of bodies. Rigid motions and shuffles: to the rounding of sums, as long as all points are used; of more points
// than max_points the order decides which, and a shuffle may move the center within its standard error. Scaling by a
// power of two with the lengths (start, noise): to the bit. m copies of each point: to the bit once there are twice as
// many points as are used, since the same ones are picked; the inliers are m times as many.
#include <agrisee/cloud/fit.hpp>

#include <numeric>

#include "properties/laws.hpp"

using namespace agrisee;

namespace {

/// The front of an ellipsoid with some strays, in double.
PointCloud<double> body(std::size_t n) {
  Rng rng(31);
  PointCloud<double> out;
  const Eigen::Vector3d radii(0.033, 0.029, 0.036);
  while (out.size() < n) {
    const Eigen::Vector3d d = rng.direction();
    if (d.y() > 0.1) continue;
    const Eigen::Vector3d normal = d.cwiseQuotient(radii).normalized();
    out.points.push_back(Eigen::Vector3d(0.1, 0.5, 0.2) + radii.cwiseProduct(d) + 5e-4 * rng.normal() * normal);
    out.normals.push_back(out.size() % 23 ? normal : rng.direction());
  }
  return out;
}

Indices all(const PointCloud<double>& cloud) {
  Indices out(cloud.size());
  std::iota(out.begin(), out.end(), Index(0));
  return out;
}

EllipsoidFit fit(const PointCloud<double>& cloud, const Ellipsoid& start, const FitParameters& parameters = {}) {
  const auto out = fit_ellipsoid(cloud, all(cloud), start, parameters);
  REQUIRE(out);
  return *out;
}

const Ellipsoid kStart(Sphere{{0.102, 0.497, 0.201}, 0.031});

}  // namespace

TEST_CASE("fits: rigid motions and shuffles") {
  const auto cloud = body(390);  // all are used
  const EllipsoidFit straight = fit(cloud, kStart);
  const auto order = laws::shuffled(cloud.size());
  const EllipsoidFit mixed = fit(select(cloud, order), kStart);
  CHECK((mixed.body.center - straight.body.center).norm() < 1e-12);
  CHECK((mixed.body.A - straight.body.A).norm() < 1e-10 * straight.body.A.norm());
  CHECK(mixed.inliers == straight.inliers);
  Rng rng(37);
  for (int i = 0; i < 20; ++i) {
    const double reach = i % 2 ? 1.0 : 1e4;
    const Pose motion = pose_from_xyz_rpy(reach * rng.direction(), 3.0 * rng.direction());
    auto moved = cloud;
    for (auto& p : moved.points) p = motion * p;
    for (auto& n : moved.normals) n = motion.linear() * n;
    Ellipsoid start = kStart;
    start.center = motion * start.center;
    const EllipsoidFit got = fit(moved, start);
    const Eigen::Matrix3d r = motion.linear();
    CHECK((got.body.center - motion * straight.body.center).norm() < 1e-12 * (1.0 + 1e3 * reach));
    CHECK((got.body.A - r * straight.body.A * r.transpose()).norm() < 1e-9 * (1.0 + reach) * straight.body.A.norm());
    CHECK((got.center_covariance - r * straight.center_covariance * r.transpose()).norm() <
          1e-7 * straight.center_covariance.norm());
    CHECK(got.rms == Approx(straight.rms).epsilon(1e-7));
    CHECK(got.inliers == straight.inliers);
  }
}

TEST_CASE("fits: another order of more points than are used stays within the standard error") {
  const auto cloud = body(3000);
  const EllipsoidFit straight = fit(cloud, kStart);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const EllipsoidFit mixed = fit(select(cloud, laws::shuffled(cloud.size(), seed)), kStart);
    CHECK((mixed.body.center - straight.body.center).norm() < 3.0 * std::sqrt(straight.center_covariance.trace()));
  }
}

TEST_CASE("fits: scales that are powers of two change nothing but the scale") {
  for (const double by : {0x1p-6, 2.0, 0x1p10}) {
    auto cloud = body(700);
    const EllipsoidFit straight = fit(cloud, kStart);
    for (auto& p : cloud.points) p *= by;
    Ellipsoid start = kStart;
    start.center *= by;
    start.A /= by;
    FitParameters parameters;
    parameters.noise *= by;
    const EllipsoidFit got = fit(cloud, start, parameters);
    CHECK(got.body.center == by * straight.body.center);
    CHECK(got.body.A == straight.body.A / by);
    CHECK(got.center_covariance == by * by * straight.center_covariance);
    CHECK(got.rms == by * straight.rms);
    CHECK(got.inliers == straight.inliers);
  }
}

TEST_CASE("fits: copies of the points change nothing") {
  const auto cloud = body(1000);
  PointCloud<double> more;
  more.points = laws::repeated(cloud.points, 3);
  more.normals = laws::repeated(cloud.normals, 3);
  const EllipsoidFit once = fit(cloud, kStart), thrice = fit(more, kStart);
  CHECK(thrice.body.center == once.body.center);
  CHECK(thrice.body.A == once.body.A);
  CHECK(thrice.center_covariance == once.center_covariance);
  CHECK(std::abs(double(thrice.inliers) - 3.0 * double(once.inliers)) <= 3.0);
  const auto a = sphere_from_normals(cloud, all(cloud)), b = sphere_from_normals(more, all(more));
  REQUIRE((a && b));
  CHECK((a->center - b->center).norm() < 1e-12);
  CHECK(a->radius == Approx(b->radius).epsilon(1e-12));
}

TEST_CASE("fits: single precision gives what its points give in double") {
  const auto cloud = body(700);
  PointCloud<float> single;
  PointCloud<double> rounded;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    single.points.push_back(cloud.points[i].cast<float>());
    single.normals.push_back(cloud.normals[i].cast<float>());
    rounded.points.push_back(single.points[i].cast<double>());
    rounded.normals.push_back(single.normals[i].cast<double>());
  }
  const auto a = fit_ellipsoid(single, all(cloud), kStart);
  REQUIRE(a);
  const EllipsoidFit b = fit(rounded, kStart);
  CHECK((a->body.center - b.body.center).norm() < 1e-8);
  CHECK((a->body.A - b.body.A).norm() < 1e-6 * b.body.A.norm());
}
