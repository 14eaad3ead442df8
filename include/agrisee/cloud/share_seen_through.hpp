// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The share of a body's surface that sight lines pass through, for any source of sight lines.
#pragma once

#include <agrisee/cloud/body_shape.hpp>
#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <cmath>
#include <vector>

namespace agrisee {

/// Share (0..1) of a body's surface that more views looked through than saw.
/// @param views the views to compare
/// @param max_incidence only views that see a point of the surface at less than this angle to its normal count (rad)
/// @param eye eye(view): position of a view's sensor (m)
/// @param look look(view, p): the Sight of a view at the point p (m)
template <typename View, typename Eye, typename Look>
double share_seen_through(const std::vector<View>& views, const Ellipsoid& body, double max_incidence, Eye&& eye,
                          Look&& look) {
  const auto& directions = DirectionBins::directions();
  const auto& shares = DirectionBins::shares();
  const double cos_max = std::cos(max_incidence);
  double share = 0.0;
  for (std::size_t b = 0; b < directions.size(); ++b) {
    const Eigen::Vector3d p = body.surface(directions[b]), n = body.normal(p);
    int through = 0, surface = 0;
    for (const View& view : views) {
      if ((eye(view) - p).normalized().dot(n) < cos_max) continue;
      const Sight sight = look(view, p);
      through += sight == Sight::through;
      surface += sight == Sight::surface;
    }
    if (through > surface) share += shares[b];
  }
  return share;
}

}  // namespace agrisee
