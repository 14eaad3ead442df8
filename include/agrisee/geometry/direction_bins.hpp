// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Divides the directions around a point into bins of nearly equal solid angle, to measure from how many sides a body
/// has been seen.
#pragma once

#include <agrisee/core/types.hpp>

#include <array>
#include <cmath>

namespace agrisee {

namespace detail {

/// Tangents of the borders between bins, as angles from the middle of a face; written out, so that a direction has the
/// same bin on every computer.
template <int Side>
struct BinBorders;
/// Borders every 15 degrees.
template <>
struct BinBorders<6> {
  static constexpr std::array<double, 2> kTangents = {0.26794919243112270647, 0.57735026918962576451};
};
/// Borders every 11.25 degrees.
template <>
struct BinBorders<8> {
  static constexpr std::array<double, 3> kTangents = {0.19891236737965800691, 0.41421356237309504880,
                                                      0.66817863791929891999};
};

}  // namespace detail

/// Bins of directions: Side x Side on each face of a cube, at equal angular steps. Side is 6 or 8.
template <int Side>
struct CubeBins {
  static constexpr int kSide = Side;                ///< bins along an edge of the cube
  static constexpr int kCount = 6 * kSide * kSide;  ///< bins in total

  /// The bin of a direction of any length but zero.
  static int bin(const Eigen::Vector3d& d) {
    Eigen::Index axis;
    const double largest = d.cwiseAbs().maxCoeff(&axis);
    const int face = static_cast<int>(axis) * 2 + (d[axis] < 0.0 ? 1 : 0);
    const auto cell = [&](double x) {
      int steps = 0;  // from the middle of the face
      for (const double border : detail::BinBorders<Side>::kTangents) steps += std::abs(x) >= border * largest;
      return x >= 0.0 ? kSide / 2 + steps : kSide / 2 - 1 - steps;
    };
    return (face * kSide + cell(d[(axis + 1) % 3])) * kSide + cell(d[(axis + 2) % 3]);
  }

  /// The central direction (unit) of each bin.
  static const std::array<Eigen::Vector3d, kCount>& directions() {
    static const std::array<Eigen::Vector3d, kCount> table = [] {
      std::array<Eigen::Vector3d, kCount> t;
      for (int b = 0; b < kCount; ++b) at(t, b) = direction(b, 0.5, 0.5);
      return t;
    }();
    return table;
  }

  /// The solid angle of each bin as a share of the sphere; the shares sum to 1.
  static const std::array<double, kCount>& shares() {
    static const std::array<double, kCount> table = [] {
      std::array<double, kCount> t{};
      double sum = 0.0;
      constexpr int kFine = 8;
      for (int b = 0; b < kCount; ++b)
        for (int i = 0; i < kFine; ++i)
          for (int j = 0; j < kFine; ++j) {
            const double a0 = double(i) / kFine, a1 = double(i + 1) / kFine;
            const double b0 = double(j) / kFine, b1 = double(j + 1) / kFine;
            const Eigen::Vector3d p = direction(b, a0, b0), q = direction(b, a1, b0), r = direction(b, a1, b1),
                                  s = direction(b, a0, b1);
            at(t, b) += 0.5 * ((q - p).cross(r - p).norm() + (r - p).cross(s - p).norm());
          }
      for (double x : t) sum += x;
      for (double& x : t) x /= sum;
      return t;
    }();
    return table;
  }

 private:
  /// The direction (unit) at the fractions fu, fv in [0, 1] of bin b along the two axes of its face.
  static Eigen::Vector3d direction(int b, double fu, double fv) {
    const int face = b / (kSide * kSide), u = (b / kSide) % kSide, v = b % kSide;
    const int axis = face / 2;
    Eigen::Vector3d d;
    d[axis] = face % 2 ? -1.0 : 1.0;
    d[(axis + 1) % 3] = std::tan(((u + fu) / kSide * 2.0 - 1.0) * kPi / 4.0);
    d[(axis + 2) % 3] = std::tan(((v + fv) / kSide * 2.0 - 1.0) * kPi / 4.0);
    return d.normalized();
  }
};

/// The usual bins, 15 degrees wide.
using DirectionBins = CubeBins<6>;

}  // namespace agrisee
