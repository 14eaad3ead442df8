// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Cheap tests of whether the masks of a frame can be those of fruit. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/sensor/depth_frame.hpp>

#include <optional>
#include <string>

namespace agrisee::sensor {

/// Check that the instances of a frame can be masks: that there are at most 1000, and that neighboring pixels of more
/// than a few belong to the same one. In a depth image that was taken for masks they do not.
/// @throws InputError that names the likely cause
void check_masks(const DepthFrame& frame);

/// What speaks against the masks of a frame: one number for all fruit, whose parts lie far apart, or for the
/// background, which fills most of the image; or a detection without a box that no pixel shows. Empty for usual masks.
std::optional<std::string> doubt_of_masks(const DepthFrame& frame);

}  // namespace agrisee::sensor
