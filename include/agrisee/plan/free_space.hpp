// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the sight lines of past views say about space: a place through which the sensor looked holds no surface.
///
/// Each view's cells keep the raw depth. A sight line that ends well behind a place went through it; where nearly every
/// pixel on a surface returns, one that returned nothing went through too. Metres, world. Cost: one projection a view.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/geometry/direction_bins.hpp>
#include <agrisee/plan/parameters.hpp>
#include <agrisee/sensor/surface_image.hpp>

namespace agrisee::plan {

/// What one view says of a place.
enum class Sight {
  unknown,  ///< outside the image, or hidden behind something
  surface,  ///< the sight line ends there
  through   ///< it goes on behind
};

/// What `view` says of the point p (m, world).
inline Sight sight(const sensor::SurfaceImage& view, const Eigen::Vector3d& p, const FreeSpaceParameters& parameters) {
  double z = 0.0;
  const std::ptrdiff_t c = view.cell(p, &z);
  if (c < 0) return Sight::unknown;
  const double measured = double(view.depth[static_cast<std::size_t>(c)]);
  const double margin = std::max(parameters.margin, 3.0 * view.noise);
  if (!(measured > 0.0)) return view.fill >= parameters.min_fill ? Sight::through : Sight::unknown;
  if (measured > z + margin) return Sight::through;
  return measured > z - margin ? Sight::surface : Sight::unknown;
}

/// True when all sight lines of `view` around the point p (m, world; the 3 x 3 cells about it) went through: the
/// surfaces' borders, where a cell sees both sides, refute nothing.
inline bool refutes(const sensor::SurfaceImage& view, const Eigen::Vector3d& p, const FreeSpaceParameters& parameters) {
  double z = 0.0;
  const std::ptrdiff_t c = view.cell(p, &z);
  if (c < 0) return false;
  const auto width = static_cast<std::ptrdiff_t>(view.intrinsics.width);
  const std::ptrdiff_t u = c % width, v = c / width;
  if (u < 1 || v < 1 || u + 1 >= width || v + 1 >= view.intrinsics.height) return false;
  const double margin = std::max(parameters.margin, 3.0 * view.noise);
  for (std::ptrdiff_t dv = -1; dv <= 1; ++dv)
    for (std::ptrdiff_t du = -1; du <= 1; ++du) {
      const double measured = double(view.depth[static_cast<std::size_t>((v + dv) * width + u + du)]);
      if (measured > 0.0 ? measured <= z + margin : view.fill < parameters.min_fill) return false;
    }
  return true;
}

/// Share (0..1) of a body's surface through which some view looked, where no view saw it.
inline double seen_through(const std::vector<sensor::SurfaceImage>& views, const Ellipsoid& body,
                           const FreeSpaceParameters& parameters = {}) {
  const auto& directions = DirectionBins::directions();
  const auto& shares = DirectionBins::shares();
  const double cos_max = std::cos(parameters.max_incidence);
  double share = 0.0;
  for (std::size_t b = 0; b < directions.size(); ++b) {
    const Eigen::Vector3d p = body.surface(directions[b]);
    const Eigen::Vector3d n = body.normal(p);
    int through = 0, surface = 0;
    for (const auto& view : views) {
      const Eigen::Vector3d ray = (p - view.world_T_optical.translation()).normalized();
      if (-ray.dot(n) < cos_max) continue;
      const Sight s = sight(view, p, parameters);
      through += s == Sight::through;
      surface += s == Sight::surface;
    }
    if (through > surface) share += shares[b];
  }
  return share;
}

}  // namespace agrisee::plan
