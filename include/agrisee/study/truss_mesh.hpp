// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Meshes for the parts of a generated truss: fruit, tubes (rachis and pedicels), calyces and leaflets. Fruit and tubes
/// are closed; calyces and leaflets are open sheets. Metres. Triangles are counter-clockwise as seen from outside. The
/// cost is linear in the number of triangles.
#pragma once

#include <agrisee/geometry/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace agrisee::study {

/// The shape of a fruit, star-shaped about its own origin. The defaults give a tomato: an oblate spheroid with mild
/// lobes around it and a dimple at the calyx. The last six fields give other fruit. The z axis of the body frame is the
/// growth axis, and the calyx lies at +z. Below, u is the cosine of the angle to the growth axis.
struct FruitShape {
  double equatorial = 0.036;      ///< semi-axis across the growth axis (m)
  double polar = 0.033;           ///< semi-axis along the growth axis (m)
  int lobes = 5;                  ///< number of lobes around the axis
  double lobe_amplitude = 0.015;  ///< height of the lobes, relative to the radius
  double lobe_phase = 0.0;        ///< turn of the lobes about the axis (rad)
  double dimple_depth = 0.12;     ///< depth of the dimple at the calyx, relative to the radius
  double dimple_width = 0.35;     ///< half width of the dimple, as an angle at the origin (rad)
  double blossom_depth = 0.0;     ///< depth of a second dimple opposite the calyx, relative to the radius
  double blossom_width = 0.35;    ///< half width of that dimple, as an angle at the origin (rad)
  double taper = 0.0;           ///< multiplies `equatorial` by 1 + taper u: below 0 for a pear, above for a strawberry
  double blockiness = 2.0;      ///< exponent of the outline: 2 is an ellipse, 3 a bell pepper
  double lobe_sharpness = 1.0;  ///< above 1, the lobes are broad and the furrows between them narrow
  double lobe_reach = 1.0;      ///< the lobes fade towards the poles as (1 - u^2)^lobe_reach

  /// Distance (m) from the origin to the surface in the direction of the unit vector `d` (body frame).
  double radius(const Eigen::Vector3d& d) const;
  /// An upper bound of radius() over all directions (m).
  double max_radius() const {
    const double corner = std::pow(2.0, 0.5 - 1.0 / blockiness);  // how far a block reaches beyond its ellipse
    return std::max(equatorial * (1.0 + std::abs(taper)), polar) * (1.0 + lobe_amplitude) * corner;
  }
};

/// Makes the closed mesh of a fruit in its body frame. It has 2 slices (stacks - 1) triangles, 2,976 by default.
/// @param shape of the fruit
/// @param slices number of meridians, 3 or more
/// @param stacks number of bands between the poles, 2 or more
/// @throws ParameterError for fewer slices or stacks
Mesh fruit_mesh(const FruitShape& shape, int slices = 48, int stacks = 32);

/// Makes a closed tube with flat ends around a polyline. Its radius changes linearly, point by point, from
/// `radius_begin` to `radius_end`. The cross-section follows the polyline without twist. Repeated points of the
/// polyline are dropped.
/// @param path polyline with at least two different points (m)
/// @param radius_begin radius at the first point (m)
/// @param radius_end radius at the last point (m)
/// @param sides number of corners of the cross-section, 3 or more
/// @throws ParameterError for fewer sides, InputError if the path has fewer than two different points
Mesh tube_mesh(const std::vector<Eigen::Vector3d>& path, double radius_begin, double radius_end, int sides = 10);

/// Makes a calyx in the body frame of its fruit: a star of pointed sepals that lie on the fruit's shoulders and curl up
/// at their tips.
/// @param shape of the fruit
/// @param sepals number of sepals
/// @param length of a sepal along the surface (m)
/// @param lift height of the tips above the surface (m)
/// @param phase turn of the star about the growth axis (rad)
Mesh calyx_mesh(const FruitShape& shape, int sepals, double length, double lift, double phase);

/// Makes a leaflet: a pointed, toothed, folded and drooping sheet. It starts at the origin and extends along x; its
/// upper side faces +z.
/// @param length, width overall size (m)
/// @param fold angle of each half above the xy plane (rad)
/// @param droop how far the tip hangs below the xy plane (m)
Mesh leaf_mesh(double length, double width, double fold, double droop);

}  // namespace agrisee::study
