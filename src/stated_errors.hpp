// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the views of a scan say of the errors of its fruit. Metres, world.
#pragma once

#include <agrisee/fuse/views.hpp>
#include <agrisee/parameters.hpp>
#include <agrisee/result.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee {

/// Tell from how far the views disagree how far centers, volumes and masses of the bodies may be off.
/// @param fruits as located in the map's cloud
void state_errors(const fuse::Views& map, const Parameters& parameters, std::vector<Fruit>& fruits);

/// Doubt the calibration if the views show the fruit in other places, with the change of it or the motion of the plant
/// that would make them agree. The shift and the change of volume that it would cause are added to each fruit's
/// stated errors. If the plant moved, the motion is added to every fruit's, as a body fitted to both places may be too
/// small.
/// @param fruits as located in the map's cloud
/// @return the doubt as a sentence, see doubt_of
std::optional<std::string> doubt_calibration(const fuse::Views& map, const Parameters& parameters,
                                             std::vector<Fruit>& fruits);

}  // namespace agrisee
