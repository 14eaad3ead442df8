// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Checks of a ready cloud: whether its points contradict its viewpoint. The source also defines check_origin and
/// check_units of process.hpp.
#pragma once

#include <agrisee/process.hpp>

#include <string>
#include <vector>

namespace agrisee {

/// Doubt one viewpoint from which many points would be hidden behind others. Those of single views, real ones and such
/// with much noise included, hide less than 1 % of their points, those of three views and more at least 6 %.
/// @param cloud points (m)
/// @param parameters only the expected radii are used
/// @param origin where the points are said to be seen from
/// @param warnings receives the doubt if the viewpoint is trusted
/// @throws InputError with the doubt if it is not
void check_hidden(const Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin,
                  std::vector<std::string>& warnings);

/// Doubt one viewpoint on the hollow side of what should be fruit.
/// @param cloud points (m) with normals
/// @param parameters only the expected radii are used
/// @param origin where the points are said to be seen from
/// @param warnings receives the doubt if it is small, or the viewpoint is trusted
/// @throws InputError with the doubt otherwise
void check_side(const Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin,
                std::vector<std::string>& warnings);

}  // namespace agrisee
