// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/spherical_harmonics.hpp>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("spherical harmonics: orthogonal, with a mean square of 1") {
  const SphericalHarmonics basis({6, 4, -1, 5, 4, -1, 8});
  CHECK(basis.size() == 7 + 2 * 4 + 2 * 3 + 2 * 1 + 2 * 3);
  const auto n = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd values(n);
  const int directions = 20000;
  for (int i = 0; i < directions; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / directions, phi = 2.399963229728653 * i, s = std::sqrt(1.0 - z * z);
    basis.values({s * std::cos(phi), s * std::sin(phi), z}, values.data());
    products += values * values.transpose() / directions;
  }
  CHECK((products - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff() < 1e-3);
}

TEST_CASE("spherical harmonics: known values, also at the poles") {
  const SphericalHarmonics basis({2, 2});
  REQUIRE(basis.size() == 7);
  std::vector<double> v(7);
  const Eigen::Vector3d u = Eigen::Vector3d(0.3, -0.4, 0.5).normalized();
  basis.values(u, v.data());
  CHECK(v[0] == Approx(1.0));
  CHECK(v[1] == Approx(std::sqrt(3.0) * u.z()));
  CHECK(v[2] == Approx(std::sqrt(5.0) * 0.5 * (3.0 * u.z() * u.z() - 1.0)));
  CHECK(v[3] == Approx(std::sqrt(3.0) * u.x()));
  CHECK(v[4] == Approx(std::sqrt(3.0) * u.y()));
  CHECK(v[5] == Approx(std::sqrt(15.0) * u.x() * u.z()));
  CHECK(v[6] == Approx(std::sqrt(15.0) * u.y() * u.z()));
  CHECK(basis.terms()[6].degree == 2);
  CHECK(basis.terms()[6].order == 1);
  basis.values(-Eigen::Vector3d::UnitZ(), v.data());
  CHECK(v[1] == Approx(-std::sqrt(3.0)));
  CHECK(v[3] == Approx(0.0));
}

TEST_CASE("spherical harmonics: slope along the meridian") {
  const SphericalHarmonics basis({8, 2});
  const auto n = static_cast<Eigen::Index>(basis.size());
  Eigen::VectorXd c(n);
  for (Eigen::Index i = 0; i < n; ++i) c[i] = std::cos(3.0 * static_cast<double>(i));
  c.tail(4).setZero();
  Eigen::VectorXd a(n), b(n);
  for (const double t : {0.1, 0.9, 2.5}) {
    basis.values({std::sin(t + 1e-5), 0.0, std::cos(t + 1e-5)}, b.data());
    basis.values({std::sin(t - 1e-5), 0.0, std::cos(t - 1e-5)}, a.data());
    const double slope = (b - a).dot(c) / 2e-5;
    const Eigen::Vector3d u(std::sin(t), 0.0, std::cos(t));
    basis.values(u, a.data());
    CHECK(basis.slope(u, a.data(), c) == Approx(slope).epsilon(1e-6));
  }
  basis.values(Eigen::Vector3d::UnitZ(), a.data());
  CHECK(basis.slope(Eigen::Vector3d::UnitZ(), a.data(), c) == 0.0);
}
