// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Decides where the fruit and the stems of a generated plant are. World frame: z points up, and the robot looks along
/// +y. Metres.
#pragma once

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/study/plant.hpp>

#include <vector>

#include "plant_style.hpp"
#include "truss_layout.hpp"

namespace agrisee::study {

/// A polyline (m, world).
using Polyline = std::vector<Eigen::Vector3d>;

/// The fruit and the stems of a plant.
struct PlantLayout {
  std::vector<TrussLayout> trusses;  ///< where the fruit hang on the main stem, it is the rachis
  std::vector<Polyline> peduncles;   ///< from the main stem to the rachis, one per truss; none if that is the main stem
  std::vector<Polyline> stems;       ///< main stems, from top to bottom
  double stem_radius = 0.0065;       ///< m
  Aabb fruits;                       ///< box around all fruit
  double back = 0.0;                 ///< y of the rear of fruit, stems and trough (m)
  double ground = 0.0;               ///< height at which the main stems end (m)
  Aabb trough;                       ///< that the plant grows in, or empty

  /// Largest interpenetration() of any two fruit (m); negative if no two fruit touch.
  double deepest() const;
};

/// Draws the layout of a plant. The box around its fruit has its middle at `parameters.center`.
PlantLayout draw_plant(const PlantParameters& parameters, const PlantStyle& style, Rng& rng);

/// The mesh of main stems, strings, rachises, pedicels and calyces.
Mesh plant_stem_mesh(const PlantLayout& layout, const PlantStyle& style, Rng& rng);

/// A smooth curve (Catmull-Rom spline) through all of at least two points, with `segments` pieces between neighbors.
Polyline smooth_curve(const Polyline& through, int segments);

}  // namespace agrisee::study
