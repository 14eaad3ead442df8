// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Part of a sphere as a cloud, and the verdict on it.
#pragma once

#include <agrisee/cloud/body_verdict.hpp>

#include <cmath>
#include <random>
#include <vector>

namespace agrisee::test {

/// Log-odds of a probability, not limited.
inline double exact_log_odds(double p) { return std::log(p / (1.0 - p)); }

constexpr double kRadius = 0.03;  // of the sphere (m)

/// Points of a sphere about the origin within an angle of the direction -y, from where a camera might look.
inline Cloud cap(double angle, double noise = 0.0) {
  Cloud cloud;
  std::mt19937 random(1);
  std::normal_distribution<double> error(0.0, 1.0);
  const double golden = kPi * (3.0 - std::sqrt(5.0));
  constexpr int kAll = 2000;
  for (int i = 0; i < kAll; ++i) {
    const double y = 1.0 - 2.0 * (i + 0.5) / kAll, across = std::sqrt(1.0 - y * y);
    const Eigen::Vector3d d(across * std::cos(golden * i), y, across * std::sin(golden * i));
    if (-d.y() < std::cos(angle)) continue;
    const Eigen::Vector3d tilt(error(random), error(random), error(random));
    cloud.points.push_back(((kRadius + 0.02 * noise * error(random)) * d).cast<float>());
    cloud.normals.push_back((d + noise * tilt).normalized().cast<float>());
  }
  return cloud;
}

/// A fit of the whole sphere.
/// @param rms of its misfit (m)
inline EllipsoidFit fit_of(double rms) {
  EllipsoidFit fit;
  fit.body = Ellipsoid(Sphere{Eigen::Vector3d::Zero(), kRadius});
  fit.rms = rms;
  return fit;
}

/// The verdict on the sphere by a cloud.
inline detail::Verdict verdict_of(const Cloud& cloud, const SeenThrough& through = {}) {
  const Grid<float> grid(cloud, 0.006f);
  return detail::judge(cloud, grid, std::vector<char>(cloud.size(), 0), fit_of(0.0).body, BodyParameters(), {through});
}

}  // namespace agrisee::test
