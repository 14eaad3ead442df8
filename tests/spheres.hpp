// SPDX-License-Identifier: BSD-3-Clause
// Scenes of spheres that tests can compute by hand: depth frames by analytic ray casting, and even samples.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/core/pose.hpp>
#include <agrisee/core/random.hpp>
#include <agrisee/sensor/depth_frame.hpp>

namespace agrisee::test {

using agrisee::Sphere;

/// Three fruit of a small truss, the third behind the others.
inline const std::vector<Sphere> kThreeFruit = {
    {{-0.03, 0.53, 0.2}, 0.035}, {{0.045, 0.54, 0.21}, 0.033}, {{0.01, 0.60, 0.20}, 0.034}};

/// Depth frame of spheres, with Gaussian noise along the ray.
inline sensor::DepthFrame render(const std::vector<Sphere>& spheres, const sensor::Intrinsics& k,
                                 const Pose& world_T_optical, double noise = 0.0, std::uint64_t seed = 1) {
  sensor::DepthFrame frame;
  frame.intrinsics = k;
  frame.depth.assign(k.size(), 0.0f);
  const Eigen::Vector3d eye = world_T_optical.translation();
  for (int v = 0; v < k.height; ++v) {
    Rng rng(seed, static_cast<std::uint64_t>(v));
    for (int u = 0; u < k.width; ++u) {
      const Eigen::Vector3d ray = k.ray(u, v);
      const Eigen::Vector3d d = world_T_optical.linear() * ray.normalized();
      double nearest = 1e9;
      for (const Sphere& s : spheres) {
        const Eigen::Vector3d c = s.center - eye;
        const double along = c.dot(d), off_sq = c.squaredNorm() - along * along;
        if (along > 0.0 && off_sq < s.radius * s.radius)
          nearest = std::min(nearest, along - std::sqrt(s.radius * s.radius - off_sq));
      }
      const double error = noise > 0.0 ? noise * rng.normal() : 0.0;
      if (nearest < 1e8)
        frame.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u)] =
            static_cast<float>((nearest + error) / ray.norm());
    }
  }
  return frame;
}

/// Points with normals on a sphere, `spacing` apart, where keep(direction) holds.
template <typename Keep>
void add_sphere(Cloud& cloud, const Sphere& s, double spacing, Keep&& keep, double noise = 0.0,
                std::uint64_t seed = 1) {
  Rng rng(seed);
  const int n = static_cast<int>(4.0 * kPi * s.radius * s.radius / (spacing * spacing));
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n, a = 2.399963229728653 * i, q = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d d(q * std::cos(a), q * std::sin(a), z);
    if (!keep(d)) continue;
    cloud.points.push_back((s.center + (s.radius + noise * rng.normal()) * d).cast<float>());
    cloud.normals.push_back(d.cast<float>());
  }
}

/// A point in a direction from the center of a sphere, at some radii from it, its normal turned away by an angle (rad).
inline void add_point(Cloud& cloud, const Sphere& s, const Eigen::Vector3d& direction, double radii,
                      double turned = 0.0) {
  const Eigen::Vector3d d = direction.normalized();
  cloud.points.push_back((s.center + s.radius * radii * d).cast<float>());
  cloud.normals.push_back((std::cos(turned) * d + std::sin(turned) * d.unitOrthogonal()).cast<float>());
}

inline bool everywhere(const Eigen::Vector3d&) { return true; }

}  // namespace agrisee::test
