// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What sight lines and masks say of the bodies in a cloud, and of what kind the cloud is.
#pragma once

#include <agrisee/cloud/mask_evidence.hpp>
#include <agrisee/cloud/seen_through.hpp>

namespace agrisee {

/// Evidence for bodies and against them, beside the points of their cloud. Each part is empty where nothing is known.
struct BodyEvidence {
  SeenThrough seen_through = {};  ///< of free space
  SeenOn seen_on = {};            ///< of the sensor of a single view
  MaskEvidence masks = {};        ///< of a detector or, where there is none, of colors

  /// Whether the cloud is known to be of a single view. BodyParameters::several_views tells the others apart.
  bool single_view() const { return static_cast<bool>(seen_on); }
};

}  // namespace agrisee
