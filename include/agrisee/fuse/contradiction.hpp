// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether two views show the same world. A view whose pose is wrong, or whose frame does not belong to its pose, puts
/// surface where another view looked through, and looks through surface that another view saw.
#pragma once

#include <agrisee/fuse/free_space.hpp>

namespace agrisee::fuse {

/// How points of one view compare with another view.
struct Evidence {
  std::size_t agree = 0;   ///< points that the other view saw, too
  std::size_t refute = 0;  ///< points that the other view looked through

  /// Number of points that the other view says something of.
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

/// Every how many points of an image one is compared, so that some 1000 are.
std::size_t compared_step(const sensor::SurfaceImage& image);

/// What view `b` says of some of the surface points of view `a`, and the other way round. Defined in
/// `agrisee::agrisee`.
/// @pre the images hold their points with normals, or the ones that are compared
Evidence compare(const sensor::SurfaceImage& a, const sensor::SurfaceImage& b, const FreeSpaceParameters& parameters);

}  // namespace agrisee::fuse
