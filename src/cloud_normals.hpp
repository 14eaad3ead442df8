// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Normals for a ready cloud that lacks some or all of them, and the noise that is measured on the way.
#pragma once

#include <agrisee/process.hpp>

namespace agrisee {

/// What the sensor's errors do to a cloud: standard deviations, 0 where they are not known.
struct CloudNoise {
  double points = 0.0;   ///< of the points about their own surface (m)
  double normals = 0.0;  ///< of the angle of their normals (rad), if errors of neighbors are alike
};

/// Standard deviation (m) of the points about their own surface, from neighborhoods of a certain radius (m).
double noise_within(const Cloud& cloud, double radius, const BodyParameters& bodies);

/// Standard deviation (m) of the points about their own surface, from the neighborhoods in which normals are estimated;
/// 0 if `adaptive_normals` is off.
double point_noise(const Cloud& cloud, const Parameters& parameters);

/// Whether any point came with a normal. Normals that are zero or not finite are none.
bool has_normals(const Cloud& cloud);

/// Give every point of a cloud a normal: turned to where the point was seen from; where that is not known, so that
/// neighbors agree.
/// @param origin where the points were seen from, as check_origin allows
/// @return the cloud's noise; zeros if more than half of the normals came with the cloud, or if `adaptive_normals` is
///   off
CloudNoise provide_normals(Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin, int threads);

}  // namespace agrisee
