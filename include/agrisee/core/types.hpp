// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Types, constants and small helpers that every module uses. Units are metres, radians and seconds throughout the
/// library.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace agrisee {

/// A point or a direction in space.
template <typename S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
/// A 3 x 3 matrix.
template <typename S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;

/// A matrix that is stored without alignment, as Transform is, so that what holds it has one layout.
template <int Rows, int Columns>
using Unaligned = Eigen::Matrix<double, Rows, Columns, Eigen::DontAlign>;
/// A 6 x 6 matrix.
using Matrix6 = Unaligned<6, 6>;

/// Index of a point in a cloud.
using Index = std::int32_t;
/// Indices of points in a cloud, ascending unless a function says otherwise.
using Indices = std::vector<Index>;
/// One label per point of a cloud. Instances are numbered from 1; 0 means that the point belongs to none.
using Labels = std::vector<int>;

/// The color of a pixel or a point: red, green and blue, 0..255 each, encoded as sRGB (IEC 61966-2-1).
using Rgb = std::array<std::uint8_t, 3>;

/// Joint angles (rad) of a six-axis arm in the controller's convention, shoulder pan to wrist 3.
using Joints = Eigen::Matrix<double, 6, 1>;

constexpr double kPi = 3.14159265358979323846;  ///< pi
constexpr double kTwoPi = 2.0 * kPi;            ///< a full turn (rad)

/// Converts degrees to radians.
constexpr double deg(double degrees) { return degrees * (kPi / 180.0); }

/// Element `i` of a vector, by reference: `v[i]` for a signed index, which must lie in [0, v.size()).
template <typename V>
decltype(auto) at(V& v, Index i) {
  return v[static_cast<std::size_t>(i)];
}

/// d of [1]: the default distance (m) from the sensor to its target.
constexpr double kViewDistance = 0.38;

}  // namespace agrisee
