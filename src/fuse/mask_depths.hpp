// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the depths under a mask say of a body that the mask proposes. Metres. Cost: a sort of the mask's pixels.
#pragma once

#include "fuse/mask_outline.hpp"

namespace agrisee::fuse {

/// What the depths under a mask say of a body; see mask_evidence.
struct DepthsUnder {
  double agreement = 0.0;  // g
  double bulge = 0.0;      // b
  double flatness = 0.0;   // f
  double boxed = 0.0;      // 1 for an instance that has a box and no mask
};

/// Judge a body by the depths under one mask.
/// @param instance the mask's
/// @param body world
DepthsUnder judge_depths(const MaskImage& image, std::uint16_t instance, const Ellipsoid& body);

}  // namespace agrisee::fuse
