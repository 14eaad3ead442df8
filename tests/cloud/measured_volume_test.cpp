// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/measured_volume.hpp>
#include <agrisee/core/random.hpp>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// Points with normals on the body r(direction), where `seen` says so.
template <typename Radius, typename Seen>
Cloud surface(Radius&& radius, Seen&& seen, std::size_t points = 4000, double noise = 0.0) {
  Cloud cloud;
  Rng rng(3);
  while (cloud.size() < points) {
    const Eigen::Vector3d d = Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).normalized();
    if (!seen(d)) continue;
    const double h = 1e-4;
    const Eigen::Vector3d u = d.unitOrthogonal(), v = d.cross(u);
    const auto at = [&](const Eigen::Vector3d& e) -> Eigen::Vector3d {
      return radius(e.normalized()) * e.normalized();
    };
    const Eigen::Vector3d n = (at(d + h * u) - at(d - h * u)).cross(at(d + h * v) - at(d - h * v)).normalized();
    const Eigen::Vector3d p = at(d) + noise * rng.normal() * n;
    cloud.points.push_back(p.cast<float>());
    cloud.normals.push_back(n.cast<float>());
  }
  return cloud;
}

template <typename Radius>
double true_volume(Radius&& radius) {
  double sum = 0.0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n, phi = 2.399963229728653 * i, q = std::sqrt(1.0 - z * z);
    sum += std::pow(radius(Eigen::Vector3d(q * std::cos(phi), q * std::sin(phi), z)), 3);
  }
  return 4.0 / 3.0 * kPi * sum / n;
}

Indices all(const Cloud& cloud) {
  Indices out(cloud.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<Index>(i);
  return out;
}

const auto everywhere = [](const Eigen::Vector3d&) { return true; };

}  // namespace

TEST_CASE("the volume of a sphere is exact, however little of it was seen") {
  const auto radius = [](const Eigen::Vector3d&) { return 0.03; };
  const double truth = 4.0 / 3.0 * kPi * std::pow(0.03, 3);
  for (const double above : {-1.0, 0.0, 0.8}) {
    const Cloud cloud = surface(radius, [&](const Eigen::Vector3d& d) { return d.z() >= above; });
    CHECK(*measured_volume(cloud, all(cloud), Eigen::Vector3d::Zero()) == Approx(truth).epsilon(1e-4));
  }
  const Cloud noisy = surface(radius, everywhere, 2000, 0.0006);
  CHECK(*measured_volume(noisy, all(noisy), Eigen::Vector3d::Zero()) == Approx(truth).epsilon(0.01));
}

TEST_CASE("bodies seen from all sides: volume within two in a hundred, from any point inside") {
  const auto ellipsoid = [](const Eigen::Vector3d& d) {
    return 1.0 / std::sqrt(d.x() * d.x() / 9e-4 + d.y() * d.y() / 7e-4 + d.z() * d.z() / 11e-4);
  };
  const auto pear = [](const Eigen::Vector3d& d) {
    return 0.03 * (1.0 + 0.12 * d.z() * std::abs(d.z()) + 0.1 * d.z());
  };
  const Cloud a = surface(ellipsoid, everywhere), b = surface(pear, everywhere);
  for (const Eigen::Vector3d& c : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.002, -0.001, 0.001)}) {
    CHECK(*measured_volume(a, all(a), c) == Approx(true_volume(ellipsoid)).epsilon(0.02));
    CHECK(*measured_volume(b, all(b), c) == Approx(true_volume(pear)).epsilon(0.02));
  }
}

TEST_CASE("a tapering body of which the end was not seen") {
  const auto apple = [](const Eigen::Vector3d& d) { return 0.04 * (1.0 - 0.10 * d.z() - 0.06 * d.z() * d.z()); };
  const Cloud cloud = surface(apple, [](const Eigen::Vector3d& d) { return d.z() < 0.45; });
  CHECK(*measured_volume(cloud, all(cloud), Eigen::Vector3d::Zero()) == Approx(true_volume(apple)).epsilon(0.05));
}

TEST_CASE("the volume of nothing, and parameters out of range") {
  Cloud cloud;
  CHECK_FALSE(measured_volume(cloud, {}, Eigen::Vector3d::Zero()));
  cloud.points.assign(3, Eigen::Vector3f::Zero());
  CHECK_FALSE(measured_volume(cloud, all(cloud), Eigen::Vector3d::Zero()));
  cloud.points[1] = {0.02f, 0.0f, 0.0f};
  CHECK(*measured_volume(cloud, all(cloud), Eigen::Vector3d::Zero()) == Approx(4.0 / 3.0 * kPi * 8e-6).epsilon(1e-3));
  MeasuredVolumeParameters bad;
  bad.reach = 0.0;
  CHECK_THROWS_AS(measured_volume(cloud, all(cloud), Eigen::Vector3d::Zero(), bad), ParameterError);
}
