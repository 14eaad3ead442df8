// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Places leaves on a generated plant: before the fruit until they hide the requested share of it, and behind it. World
/// frame, metres. Takes some tenths of a second; most of it are tests whether a leaf passes through something.
#pragma once

#include <agrisee/study/samples.hpp>
#include <agrisee/study/visibility.hpp>

#include <vector>

#include "plant_layout.hpp"

namespace agrisee::study {

/// Leaves of a plant.
struct Foliage {
  std::vector<Mesh> leaves;  ///< one mesh per leaf, stalks included
  double share = 0.0;        ///< share of the visible samples that they hide
};

/// Grows the leaves.
/// @param parameters `foliage` and `leaves_behind`
/// @param style of the plant
/// @param layout where fruit and stems are
/// @param solids everything that leaves may not pass through: fruit, stems and other objects, in one mesh
/// @param samples of the fruit's surface
/// @param seen which of them are visible from `eye` without leaves
/// @param eye frontal_eye()
/// @param rng random numbers
/// @return the leaves; `share` misses `parameters.foliage` where there was no room for enough of them
Foliage grow_leaves(const PlantParameters& parameters, const PlantStyle& style, const PlantLayout& layout,
                    const Mesh& solids, const Samples& samples, const Flags& seen, const Eigen::Vector3d& eye,
                    Rng& rng);

}  // namespace agrisee::study
