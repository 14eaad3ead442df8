// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How deep two bodies go into each other, and whether they are the same body. Metres.
#pragma once

#include <agrisee/cloud/body_shape.hpp>

#include <cmath>

namespace agrisee::detail {

/// How deep two bodies penetrate each other along the line between their centers (m); negative when apart.
inline double overlap(const Ellipsoid& a, const Ellipsoid& b) {
  const Eigen::Vector3d d = b.center - a.center;
  const double length = d.norm();
  if (!(length > 1e-9)) return a.mean_radius() + b.mean_radius();
  const Eigen::Vector3d u = d / length;
  return (a.surface(u) - a.center).norm() + (b.surface(-u) - b.center).norm() - length;
}

/// Whether two bodies agree in center and size to within 5 % of the radius.
inline bool alike(const Ellipsoid& a, const Ellipsoid& b) {
  const double r = a.mean_radius(), gate = 0.05 * r;
  return (a.center - b.center).norm() < gate && std::abs(b.mean_radius() - r) < gate;
}

/// Whether the centers and the semi-axes of two bodies are within 1 or 2 % of the radius.
inline bool nearly_equal(const Ellipsoid& a, const Ellipsoid& b) {
  constexpr double kSameCenter = 0.01, kSameShape = 0.02;
  const double r = a.mean_radius();
  return (a.center - b.center).norm() < kSameCenter * r && r * (a.A - b.A).norm() < kSameShape;
}

}  // namespace agrisee::detail
