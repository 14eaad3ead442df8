// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tests whether two views agree. A view whose pose is wrong, or whose frame does not belong to its pose, puts surface
/// where another view looked through, and looks through surface that another view saw.
#pragma once

#include <agrisee/fuse/free_space.hpp>

namespace agrisee::fuse {

/// How many points of one view agree with another view, and how many contradict it.
struct Evidence {
  std::size_t agree = 0;   ///< points that the other view saw too
  std::size_t refute = 0;  ///< points that the other view looked through

  /// Number of points for which the other view is evidence.
  std::size_t count() const { return agree + refute; }
  /// Share of the evidence that contradicts, 0..1; 0 without evidence.
  double contradiction() const {
    return count() > 0 ? static_cast<double>(refute) / static_cast<double>(count()) : 0.0;
  }
  /// Add other evidence.
  Evidence& operator+=(const Evidence& other) {
    agree += other.agree;
    refute += other.refute;
    return *this;
  }
};

/// Step in the points of an image with which some 1000 of them are compared.
std::size_t compared_step(const sensor::SurfaceImage& image);

/// Compares some surface points of view `a` with view `b`, and the other way round. Defined in `agrisee::agrisee`.
/// @pre the images hold their points with normals, or the ones that are compared
Evidence compare(const sensor::SurfaceImage& a, const sensor::SurfaceImage& b, const FreeSpaceParameters& parameters);

}  // namespace agrisee::fuse
