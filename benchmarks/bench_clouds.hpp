// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Clouds for the benchmarks: a truss of spheres with range noise and stray points, the same on every machine.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/core/random.hpp>

namespace agrisee::bench {

/// A truss of seven touching spheres of 35 mm radius about (0, 0.545, 0.6) m: `n` points on the spheres, 0.5 mm noise
/// along the normal, one point in fifty astray within 40 mm of it; in random order, which is hard on caches. Normals
/// are the spheres' and face outwards; `views` is empty.
inline Cloud noisy_truss(std::size_t n, std::uint64_t seed = 1) {
  const double radius = 0.035;
  Rng rng(seed);
  Cloud cloud;
  cloud.points.reserve(n);
  cloud.normals.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<double>(rng.below(7));
    const double angle = k * deg(100.0);
    const Eigen::Vector3d center(0.036 * std::cos(angle), 0.545 + 0.036 * std::sin(angle), 0.6 - 0.033 * k);
    const Eigen::Vector3d normal = rng.direction();
    const double offset = rng.uniform() < 0.02 ? rng.uniform(0.0, 0.04) : 5e-4 * rng.normal();
    cloud.points.push_back((center + (radius + offset) * normal).cast<float>());
    cloud.normals.push_back(normal.cast<float>());
  }
  return cloud;
}

}  // namespace agrisee::bench
