// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What stands around a generated plant and is no fruit: a trough, a trunk, posts, wires and pots. World frame, metres.
#pragma once

#include <agrisee/study/scene.hpp>

#include <vector>

#include "plant_layout.hpp"

namespace agrisee::study {

/// Makes the surroundings that the parameters ask for, and the trough of the layout: closed meshes, one for each
/// trough, trunk, post, wire and pot, and one for the bench below the pots. None of them meets a fruit.
std::vector<Mesh> draw_surroundings(const PlantParameters& parameters, const PlantLayout& layout, Rng& rng);

}  // namespace agrisee::study
