// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A stand-in for a detector, made of colors alone: patches of the color of fruit become masks. Defined in
/// `agrisee::agrisee`.
///
/// It knows one kind of fruit in one light, so it is off by default (ColorPriorParameters::enabled). What its masks say
/// is weighed as any detector's (masks.hpp): depths overrule a patch that makes no body.
#pragma once

#include <agrisee/cloud/parameters.hpp>
#include <agrisee/fuse/parameters.hpp>
#include <agrisee/sensor/depth_frame.hpp>

namespace agrisee::fuse {

/// Look for fruit by their color.
///
/// A pixel has the color of fruit if its hue and chroma in CIELAB are in the range, and if most of the 5 x 5 pixels
/// about it are so, too. Neighbors are of one patch unless their depths differ by more than a quarter of the largest
/// expected radius. A patch with several bulges is cut between them: the pixel farthest from the patch's border is the
/// middle of a part, then the farthest beyond 1.3 times its distance from the border, and so on down to 0.7 of the
/// first distance, where the patch is narrower between them; every pixel goes to the part in whose disc it lies
/// deepest. Parts without any depth are left out, and small ones (`least_disc`).
/// @param frame its depths (m) and colors are read
/// @param bodies expected radii
/// @return the frame with instances and detections; unchanged where a detector has looked at it, or it has no colors
/// @throws InputError for a frame whose channels differ in size; ParameterError
sensor::DepthFrame detected_by_color(sensor::DepthFrame frame, const BodyParameters& bodies = {},
                                     const ColorPriorParameters& parameters = {});

}  // namespace agrisee::fuse
