// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Free space from the sight lines of past views: a point that the camera looked through is not on a surface.
///
/// Each cell of a view's image keeps the measured depth. A sight line passes through a point if it ends well behind it.
/// In a view in which nearly every pixel on a surface returns, a sight line without return counts as passing through
/// as well. Metres, world. Cost: one projection per view.
#pragma once

#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace agrisee::fuse {

/// Whether `view` sees a surface at the point p (m, world), looks through it, or neither; unknown outside the image.
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

/// True if all sight lines of `view` around a surface point pass through the surface: those of the 3 x 3 cells about
/// it. At a surface's border, where cells see both sides, nothing is refuted. Slanted surface returns little light, so
/// a sight line without return counts only if the view would see the surface at less than 70 degrees of incidence, from
/// either side. Defined in `agrisee::agrisee`.
/// @param p the point (m, world)
/// @param normal of the surface there (unit, world)
bool refutes(const sensor::SurfaceImage& view, const Eigen::Vector3d& p, const Eigen::Vector3d& normal,
             const FreeSpaceParameters& parameters);

/// How many points of a known surface a view measures again.
struct Returned {
  std::size_t seen = 0;  ///< points where the view measures that surface
  std::size_t lost = 0;  ///< points where it measures nothing, although it looks there

  /// Add other points.
  Returned& operator+=(const Returned& other) {
    seen += other.seen;
    lost += other.lost;
    return *this;
  }
  /// Share (0..1) of the points that are measured again; 1 if there are too few points to tell.
  double share() const {
    constexpr std::size_t kEnough = 50;
    return seen + lost < kEnough ? 1.0 : static_cast<double>(seen) / static_cast<double>(seen + lost);
  }
};

/// How many surface points of another view this one measures again. Points that it sees at more than `max_incidence`,
/// occluded points, and points that it looks through do not count. In sunlight whole patches of a view return nothing.
/// This share identifies such views, in which a missing return is no evidence (SurfaceImage::fill). Defined in
/// `agrisee::agrisee`.
/// @param known holds points with normals
Returned returned(const sensor::SurfaceImage& view, const sensor::SurfaceImage& known,
                  const FreeSpaceParameters& parameters);

/// Whether more views looked through a place, to something behind it, than saw a surface there. Sight lines without
/// return do not count: near its silhouette a fruit returns nothing either. Defined in `agrisee::agrisee`.
/// @param p the place (m, world)
bool is_free(const std::vector<sensor::SurfaceImage>& views, const Eigen::Vector3d& p,
             const FreeSpaceParameters& parameters = {});

/// Share (0..1) of a body's surface that more views looked through than saw. For each point of it only views count that
/// see it at less than `max_incidence`. Defined in `agrisee::agrisee`.
double seen_through(const std::vector<sensor::SurfaceImage>& views, const Ellipsoid& body,
                    const FreeSpaceParameters& parameters = {});

}  // namespace agrisee::fuse
