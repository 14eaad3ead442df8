// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Smooth random fields over the pixels of an image.
#pragma once

#include <agrisee/sensor/intrinsics.hpp>

#include <cstdint>
#include <vector>

namespace agrisee::study {

/// A random number stream of a field.
struct FieldStream {
  std::uint64_t seed = 0;
  std::uint64_t view = 0;
  std::uint64_t field = 0;  ///< tells the fields of a view apart
};

/// A random field whose values are standard normal at every pixel and whose correlation at an angle of a is
/// exp(-0.75 (a / spacing)^2): uniform cubic B-splines over a lattice of independent normal numbers, scaled to variance
/// 1 at each pixel. A pixel's value depends on the camera and on the stream alone.
class SmoothField {
 public:
  /// @param k the camera
  /// @param spacing distance of the lattice's nodes (rad), positive
  /// @param fixed share of the variance that is drawn from `always`; the rest is drawn from `now`
  SmoothField(const sensor::Intrinsics& k, double spacing, double fixed, const FieldStream& always,
              const FieldStream& now);

  /// The values of a row of pixels.
  /// @param v the row
  /// @param u0, u1 its pixels [u0, u1)
  /// @param values receives u1 - u0 numbers
  void row(int v, int u0, int u1, std::vector<float>& values) const;

 private:
  /// The four nodes that a pixel lies between, and their weights; the squares of the weights sum up to 1.
  struct Tap {
    std::size_t node;
    float weight[4];
  };
  static std::vector<Tap> taps(int pixels, double step);

  std::vector<Tap> columns_, rows_;
  std::size_t width_ = 0;       // nodes in a row of the lattice
  std::vector<float> lattice_;  // row by row
};

}  // namespace agrisee::study
