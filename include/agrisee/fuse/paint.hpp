// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Colors the points of a cloud from the images of its views. Metres, world frame. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/fuse/masks.hpp>

#include <vector>

namespace agrisee::fuse {

/// The color of each point: the mean over the views that see it, weighted by how directly the surface faces the
/// camera. A view sees a point if its depth there agrees with that of the point to within 1 % of it, or 4 mm if that is
/// more.
/// @param cloud points (m, world), with normals or without
/// @param views views without colors are ignored
/// @return one color per point, black where no view sees it; empty if no view has colors
/// @throws InputError for a view without frame, a frame whose channels differ in size, arrays of a cloud that differ in
///   length; Cancelled
std::vector<Rgb> colors_of(const Cloud& cloud, const std::vector<DetectedView>& views);

}  // namespace agrisee::fuse
