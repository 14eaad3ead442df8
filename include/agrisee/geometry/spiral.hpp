// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Directions spread evenly over the sphere, on a spiral.
#pragma once

#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee {

constexpr double kGoldenAngle = 2.399963229728653;  ///< pi (3 - sqrt 5): successive points of a spiral turn by it (rad)

/// Unit vector `i` of `count` that are spread evenly over the sphere, from +z to -z: the spherical Fibonacci lattice
/// (Gonzalez, Mathematical Geosciences 42, 2010).
inline Eigen::Vector3d spiral_direction(int i, int count) {
  const double z = 1.0 - (2.0 * i + 1.0) / count;
  const double s = std::sqrt(1.0 - z * z);
  return {s * std::cos(kGoldenAngle * i), s * std::sin(kGoldenAngle * i), z};
}

}  // namespace agrisee
