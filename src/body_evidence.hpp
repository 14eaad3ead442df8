// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Gathers what sight lines and masks say of the bodies in a ready cloud.
#pragma once

#include <agrisee/cloud/body_evidence.hpp>
#include <agrisee/process.hpp>

namespace agrisee {

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
