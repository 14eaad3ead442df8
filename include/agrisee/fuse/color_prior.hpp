// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A simple substitute for a detector: patches of fruit color become masks. Defined in `agrisee::agrisee`.
///
/// The rule suits one kind of fruit in one light, so it is off by default (ColorPriorParameters::enabled). Its masks
/// are weighed like those of any detector (masks.hpp): depths overrule a patch that forms no body.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/sensor/depth_frame.hpp>

namespace agrisee::fuse {

/// Detect fruit by their color.
///
/// A pixel has fruit color if its CIELAB hue and chroma are in the range, and those of most of the 5 x 5 pixels around
/// it. Neighbors belong to one patch unless their depths differ by more than a quarter of the largest expected radius.
/// A patch with several bulges is split at its narrow places. The pixel farthest from the patch's border becomes the
/// middle of a part, then the farthest one outside 1.3 times its distance from the border, and so on down to 0.7 of the
/// first distance. Each pixel goes to the part in whose disc it lies deepest. Parts without depth, and small ones
/// (`least_disc`), are dropped.
/// @param frame its depths (m) and colors are read
/// @param bodies expected radii
/// @return the frame with instances and detections; unchanged if a detector has looked at it, or it has no colors
/// @throws InputError for a frame whose channels differ in size; ParameterError
sensor::DepthFrame detected_by_color(sensor::DepthFrame frame, const BodyParameters& bodies = {},
                                     const ColorPriorParameters& parameters = {});

}  // namespace agrisee::fuse
