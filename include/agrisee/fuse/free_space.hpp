// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the sight lines of past views say about space: a place that the camera looked through holds no surface.
///
/// Each cell of a view's image keeps the measured depth. A sight line that ends well behind a place went through it. In
/// a view in which nearly every pixel on a surface returns, a sight line without return went through, too. Metres,
/// world. Cost: one projection a view.
#pragma once

#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/sensor/surface_image.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace agrisee::fuse {

/// What `view` says of the point p (m, world): unknown outside the image, too.
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

/// True when all sight lines of `view` around a point of a surface went through it: the 3 x 3 cells about the point. At
/// a surface's border, where a cell sees both sides, nothing is refuted. A surface that is seen at a slant returns
/// little light, so a sight line without return counts only where the view would see the surface at less than
/// `max_incidence`. Defined in `agrisee::agrisee`.
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
  /// Share (0..1) of the points that are measured again; 1 as long as there are too few points to tell.
  double share() const {
    constexpr std::size_t kEnough = 50;
    return seen + lost < kEnough ? 1.0 : static_cast<double>(seen) / static_cast<double>(seen + lost);
  }
};

/// How many of some surface points of another view this one measures again. Points that it sees at more than
/// `max_incidence` do not count, nor do those that something hides or that it looks through to something else. In
/// sunlight whole patches of a view return nothing; this share tells such a view, where a missing return says nothing
/// (SurfaceImage::fill), from one that looks past things. Defined in `agrisee::agrisee`.
/// @param known holds points with normals
Returned returned(const sensor::SurfaceImage& view, const sensor::SurfaceImage& known,
                  const FreeSpaceParameters& parameters);

/// Share (0..1) of a body's surface that more views looked through than saw. Only views count that see a place of the
/// surface at less than `max_incidence`. Defined in `agrisee::agrisee`.
double seen_through(const std::vector<sensor::SurfaceImage>& views, const Ellipsoid& body,
                    const FreeSpaceParameters& parameters = {});

}  // namespace agrisee::fuse
