// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Gives the points of a cloud the colours that cameras saw there. Metres, world frame. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/fuse/masks.hpp>

#include <vector>

namespace agrisee::fuse {

/// The colour of each point: the mean over the views that see it, the more weight the more the surface faces the
/// camera. A view sees a point if its depth there is that of the point to within 1 % of it, and at least 4 mm.
/// @param cloud points (m, world), with normals or without
/// @param views those without colours are left out
/// @return one colour a point, black where no view sees it; empty if no view has colours
std::vector<Rgb> colors_of(const Cloud& cloud, const std::vector<DetectedView>& views);

}  // namespace agrisee::fuse
