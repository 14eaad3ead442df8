// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Meshes of the leaves of generated plants: curved blades of some thickness, and compound leaves along a rachis.
/// World frame, metres. The cost is linear in the number of triangles.
#pragma once

#include <agrisee/core/random.hpp>

#include "plant_layout.hpp"

namespace agrisee::study {

/// Thickness of the blades (m).
constexpr double kBladeThickness = 0.0004;

/// Gives an open sheet a thickness: half of it on either side, along the normals at the vertices, with a rim along the
/// border. The result is closed if no edge of the sheet belongs to more than two triangles.
Mesh thickened(const Mesh& sheet, double thickness);

/// Draws the open sheet of a leaflet. It starts at the origin and extends along x, its upper side faces +z; it is
/// pointed, toothed, cupped, twisted and drooping.
/// @param style of the plant's leaves
/// @param length of the leaflet (m)
/// @param rng random numbers
Mesh draw_leaflet(const LeafStyle& style, double length, Rng& rng);

/// The two parts of a compound leaf.
struct CompoundLeaf {
  Mesh stalks;  ///< petiole, rachis and the stalks of the leaflets; closed tubes
  Mesh blades;  ///< the leaflets, closed
};

/// Draws a compound leaf.
/// @param style of the plant's leaves
/// @param rachis of the leaf, petiole included, from the stem to the tip (m)
/// @param outward the upper side of the leaflets turns up and towards this direction
/// @param scale of the leaflets
/// @param rng random numbers
CompoundLeaf draw_compound_leaf(const LeafStyle& style, const Polyline& rachis, const Eigen::Vector3d& outward,
                                double scale, Rng& rng);

}  // namespace agrisee::study
