// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The surface that goes on outside of a body, as it does if the body is the end of something longer. Metres.
#pragma once

#include <agrisee/core/types.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

namespace agrisee::detail {

/// How far outside of a body points follow its surface, for each direction from its center.
class OutsideSurface {
 public:
  /// Points whose normal is within this cosine of the body's follow its surface. Leaves and neighbors that touch a
  /// fruit have other normals.
  static constexpr double kFollows = 0.7;

  /// Add a point that follows the surface at this distance (m); one inside of the body changes nothing.
  void add(int bin, double distance) {
    double& most = at(farthest_, bin);
    most = std::max(most, distance);
  }
  /// Add the distance (m) of a point which noise alone puts off the surface.
  void add_noise(double distance) {
    squares_ += distance * distance;
    ++count_;
  }

  /// Share (0..1) of the directions that are not covered in which points follow the surface at a distance of more than
  /// `least` (m), 0.2 radii and `deviations` standard deviations of the noise.
  /// @param radius mean radius of the body (m)
  double share(const std::bitset<DirectionBins::kCount>& covered, double radius, double least,
               double deviations) const {
    constexpr double kOutside = 0.2;
    const double noise = std::sqrt(squares_ / static_cast<double>(std::max<std::size_t>(count_, 1)));
    const double far = std::max({kOutside * radius, least, deviations * noise});
    double out = 0.0;
    for (std::size_t b = 0; b < DirectionBins::kCount; ++b)
      if (farthest_[b] > far && !covered[b]) out += DirectionBins::shares()[b];
    return out;
  }

 private:
  std::array<double, DirectionBins::kCount> farthest_{};  // m
  double squares_ = 0.0;                                  // m2
  std::size_t count_ = 0;
};

}  // namespace agrisee::detail
