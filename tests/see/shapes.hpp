// SPDX-License-Identifier: BSD-3-Clause
// Clouds and a sensor for the tests of see/.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/random.hpp>

#include <cmath>

namespace agrisee::test {

using Points = std::vector<Eigen::Vector3f>;

/// Uniform points on a rectangle [x0, x1] x [y0, y1] at z = 0.
inline Points rectangle(double x0, double x1, double y0, double y1, std::size_t n, std::uint64_t seed = 1) {
  Rng rng(seed);
  Points out;
  for (std::size_t i = 0; i < n; ++i)
    out.push_back(Eigen::Vector3d(rng.uniform(x0, x1), rng.uniform(y0, y1), 0.0).cast<float>());
  return out;
}

/// Uniform points on a sphere.
inline Points sphere(const Eigen::Vector3d& center, double radius, std::size_t n, std::uint64_t seed = 1) {
  Rng rng(seed);
  Points out;
  for (std::size_t i = 0; i < n; ++i) out.push_back((center + radius * rng.direction()).cast<float>());
  return out;
}

/// A sensor that sees random points of spheres: those that face it below 70 degrees and that no sphere hides.
struct Spheres {
  std::vector<Eigen::Vector3d> centers;
  double radius = 0.035;
  std::size_t samples = 20000;  ///< a sphere and view

  Points look(const Eigen::Vector3d& sensor, std::uint64_t seed) const {
    Points out;
    Rng rng(seed);
    for (const Eigen::Vector3d& c : centers)
      for (std::size_t i = 0; i < samples; ++i) {
        const Eigen::Vector3d n = rng.direction(), p = c + radius * n, line = sensor - p;
        if (n.dot(line.normalized()) < std::cos(deg(70))) continue;
        bool hidden = false;
        for (const Eigen::Vector3d& o : centers) {
          const double t = std::min(1.0, std::max(0.0, (o - p).dot(line) / line.squaredNorm()));
          hidden = hidden || (&o != &c && (p + t * line - o).norm() < radius);
        }
        if (!hidden) out.push_back(p.cast<float>());
      }
    return out;
  }
};

}  // namespace agrisee::test
