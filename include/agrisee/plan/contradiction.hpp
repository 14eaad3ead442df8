// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether two views tell of the same world. A view whose pose is wrong, or whose frame is not of its pose, puts
/// surface where another view looked through, and looks through surface that another view saw.
#pragma once

#include <agrisee/plan/free_space.hpp>

namespace agrisee::plan {

/// Points of views that other views saw too (`agree`), or looked through (`refute`).
struct Evidence {
  std::size_t agree = 0;   ///< points seen by others, too
  std::size_t refute = 0;  ///< points looked through

  /// All of it.
  std::size_t count() const { return agree + refute; }
  /// Share of the evidence that contradicts, 0..1; 0 without any.
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

/// Of an image's points every so-many-th is compared: some 1000 of them.
inline std::size_t compared_step(const sensor::SurfaceImage& image) {
  return std::max<std::size_t>(1, image.points.size() / 1000);
}

/// What view `b` says of some of the surface points of view `a`, and the other way round.
/// @pre the images hold their points, or those that are compared
inline Evidence compare(const sensor::SurfaceImage& a, const sensor::SurfaceImage& b,
                        const FreeSpaceParameters& parameters) {
  Evidence out;
  const auto one_way = [&](const sensor::SurfaceImage& points, const sensor::SurfaceImage& view) {
    const std::size_t step = compared_step(points);
    for (std::size_t i = 0; i < points.points.size(); i += step) {
      const Eigen::Vector3d p = points.points[i].cast<double>();
      if (refutes(view, p, parameters))
        ++out.refute;
      else if (sight(view, p, parameters) == Sight::surface)
        ++out.agree;
    }
  };
  one_way(a, b);
  one_way(b, a);
  return out;
}

}  // namespace agrisee::plan
