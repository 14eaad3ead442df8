// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What sight lines and masks say of the bodies in a ready cloud, beside its points.
#pragma once

#include <agrisee/cloud/mask_evidence.hpp>
#include <agrisee/cloud/seen_through.hpp>
#include <agrisee/process.hpp>

namespace agrisee {

/// Evidence for bodies and against them, as split() takes it. Each part is empty where nothing is known.
struct BodyEvidence {
  SeenThrough seen_through;  ///< of free space
  SeenOn seen_on;            ///< of the sensor of a single view
  MaskEvidence masks;        ///< of masks and, with `color_prior.enabled`, of colors
};

/// Gather the evidence for the bodies in a cloud.
/// @param result only its clouds (m): `cloud`, cleaned and with normals, and `raw`, with the outliers, which occlude
/// @param parameters of all stages
/// @param origin where the points were seen from, as check_origin allows, and its images
/// @param of_views evidence of free space from the views, which replaces that of sight lines; or empty
/// @param noise standard deviation (m) of the points about their own surface
/// @throws as fuse::mask_evidence
BodyEvidence evidence_for(const ScanResult& result, const Parameters& parameters, const CloudOrigin& origin,
                          const SeenThrough& of_views, double noise);

}  // namespace agrisee
