// SPDX-License-Identifier: BSD-3-Clause
// The axis of least variance equals that of an iterative solver, for covariances of all shapes.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/pca.hpp>

#include <Eigen/Eigenvalues>

#include "catch.hpp"

using namespace agrisee;

namespace {

Eigen::Matrix3d covariance_of(const Eigen::Vector3d& variance, const Eigen::Matrix3d& axes) {
  const Eigen::Matrix3d c = axes * variance.asDiagonal() * axes.transpose();
  return 0.5 * (c + c.transpose());
}

Eigen::Matrix3d random_axes(Rng& rng) {
  Eigen::Matrix3d axes;
  axes.col(0) = rng.direction();
  axes.col(1) = axes.col(0).cross(rng.direction()).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace

TEST_CASE("the least axis is that of an iterative solver") {
  Rng rng(4);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::pow(10.0, rng.uniform(-12.0, 6.0));
    Eigen::Vector3d variance(0.0, 0.0, size);
    variance[1] = size * (i % 3 == 0 ? 1.0 : std::pow(10.0, rng.uniform(i % 2 == 0 ? -17.0 : -6.0, 0.0)));
    variance[0] = variance[1] * (i % 5 == 0   ? 0.0
                                 : i % 7 == 0 ? rng.uniform(0.9, 1.0)
                                              : std::pow(10.0, rng.uniform(-9.0, 0.0)));
    const Eigen::Matrix3d covariance = covariance_of(variance, random_axes(rng));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    Eigen::Vector3d found;
    const Eigen::Vector3d axis = least_axis(covariance, found);
    INFO(i << ": " << variance.transpose());
    REQUIRE(std::abs(found[0] - solver.eigenvalues()[0]) <= 1e-11 * size);
    REQUIRE((found - solver.eigenvalues()).cwiseAbs().maxCoeff() <= 1e-5 * size);
    REQUIRE((0.0 <= found[0] && found[0] <= found[1] && found[1] <= found[2]));
    REQUIRE(std::abs(axis.norm() - 1.0) < 1e-12);
    const double gap = (variance[1] - variance[0]) / size;
    if (gap > 1e-6) REQUIRE(axis.cross(solver.eigenvectors().col(0)).norm() < 1e-13 / gap + 1e-8);
  }
}

TEST_CASE("the least axis of points on a line, or nearly so, has the least variance") {
  Rng rng(6);
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d along = rng.direction(), at = 0.5 * rng.direction();
    const double noise = std::pow(10.0, rng.uniform(-12.0, -5.0));
    Moments moments;
    moments.reset(at);
    for (int j = 0; j < 20; ++j) moments.add(at + rng.uniform(-1.0, 1.0) * along + noise * rng.direction());
    Eigen::Vector3d found;
    const Eigen::Vector3d axis = least_axis(moments.covariance(), found);
    REQUIRE((0.0 <= found[0] && found[0] <= found[1] && found[1] <= found[2]));
    REQUIRE(std::abs(axis.dot(along)) < 2e-5);
    REQUIRE(found[1] < 4.0 * noise * noise + 1e-8);
  }
}

TEST_CASE("the least axis of degenerate covariances is defined") {
  Eigen::Vector3d variance;
  CHECK(least_axis(Eigen::Matrix3d::Zero(), variance).isZero());
  CHECK(variance.isZero());
  CHECK(least_axis(Eigen::Matrix3d::Constant(std::nan("")), variance).isZero());
  CHECK(least_axis(1e-310 * Eigen::Matrix3d::Identity(), variance).isZero());
  for (int entry = 0; entry < 9; ++entry)
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      Eigen::Matrix3d one = Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal();
      one(entry / 3, entry % 3) = one(entry % 3, entry / 3) = bad;
      CHECK(least_axis(one, variance).isZero());
      CHECK(variance.isZero());
    }
  CHECK(least_axis(Eigen::Matrix3d::Constant(std::numeric_limits<double>::infinity()), variance).isZero());
  CHECK(std::abs(least_axis(Eigen::Matrix3d::Identity(), variance).norm() - 1.0) < 1e-15);
  CHECK(variance.isApprox(Eigen::Vector3d::Ones()));
  const Eigen::Vector3d line(1.0, 2.0, 2.0);
  CHECK(std::abs(least_axis(line * line.transpose(), variance).dot(line)) < 1e-14);
  CHECK(std::abs(variance[2] - 9.0) < 1e-14);
  CHECK(variance[1] < 1e-14);
}
