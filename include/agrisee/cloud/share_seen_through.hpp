// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How much of a body sight lines went through, whatever gives the sight lines.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/geometry/direction_bins.hpp>

#include <cmath>
#include <vector>

namespace agrisee {

/// Share (0..1) of a body's surface that more views looked through than saw.
/// @param views what saw the body
/// @param max_incidence only views that see a place of the surface at less than this angle to its normal count (rad)
/// @param eye eye(view): where a view's sensor stood (m)
/// @param look look(view, p): what a view says of the place p (m), a Sight
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
