// SPDX-License-Identifier: BSD-3-Clause
#include "body_evidence.hpp"

#include <agrisee/cloud/sight_lines.hpp>
#include <agrisee/fuse/color_prior.hpp>

#include <algorithm>
#include <utility>
#include <vector>

#include "cloud/searches.hpp"
#include "cloud_origin.hpp"

namespace agrisee {
namespace {

/// The sight lines of each sensor whose position is known.
std::vector<SightLines> sight_lines(const Cloud& cloud, const CloudOrigin& origin) {
  std::vector<SightLines> lines;
  if (!origin.sensors.empty() && cloud.views.size() == cloud.size()) {
    std::vector<Indices> seen(origin.sensors.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (cloud.views[i] >= 0) seen[static_cast<std::size_t>(cloud.views[i])].push_back(static_cast<Index>(i));
    for (std::size_t v = 0; v < seen.size(); ++v)
      if (!seen[v].empty()) lines.emplace_back(select(cloud, seen[v]), origin.sensors[v]);
  } else if (origin.viewpoint) {
    lines.emplace_back(cloud, *origin.viewpoint);
  }
  return lines;
}

/// Sight lines that end within this share of a body's radius from its surface end there.
constexpr double kSightMargin = 0.12;

/// Evidence of free space from the points of a cloud; empty where no body asks for it, or no sensor's place is known.
/// @param noise standard deviation (m) of the points about their own surface
SeenThrough free_space_of(const Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin, double noise) {
  if (!parameters.split.fit_bodies) return {};
  std::vector<SightLines> lines = sight_lines(cloud, origin);
  if (lines.empty()) return {};
  const double least = std::max(parameters.free_space.margin, 3.0 * noise);
  return [lines = std::move(lines), least](const Ellipsoid& body) {
    constexpr double kMaxIncidence = deg(70);  // a single view sees much at a slant
    return seen_through(lines, body, kMaxIncidence, std::max(least, kSightMargin * body.mean_radius()));
  };
}

/// Evidence of what one sensor saw where a body should be; empty where no body asks for it, or several sensors saw the
/// cloud.
/// @param cloud all points, outliers too: they occlude
/// @param noise standard deviation (m) of the points about their own surface
SeenOn seen_on_of(const Cloud& cloud, const Parameters& parameters, const CloudOrigin& origin, double noise) {
  if (!parameters.split.fit_bodies || !has_one_viewpoint(origin) || cloud.empty()) return {};
  return [lines = SightLines(cloud, *origin.viewpoint), noise](const Ellipsoid& body) {
    return seen_on(lines, body, std::max(3.0 * noise, kSightMargin * body.mean_radius()));
  };
}

/// Evidence from the masks of a detector and, where no detector looked and the color prior is enabled, of colors.
MaskEvidence masks_of(const Parameters& parameters, const CloudOrigin& origin) {
  const BodyParameters& bodies = parameters.split.bodies;
  std::vector<fuse::DetectedView> views = origin.detected;
  if (parameters.color_prior.enabled)
    for (fuse::DetectedView& v : views)
      if (!v.frame->detected && !v.frame->color.empty())
        v = {fuse::detected_by_color(*v.frame, bodies, parameters.color_prior), v.world_T_optical};
  return fuse::mask_evidence(views, bodies, parameters.masks, origin.mask_order);
}

}  // namespace

BodyEvidence evidence_for(const ScanResult& result, const Parameters& parameters, const CloudOrigin& origin,
                          const SeenThrough& of_views, double noise) {
  BodyEvidence out;
  out.masks = masks_of(parameters, origin);
  out.seen_through = of_views ? of_views : free_space_of(result.cloud, parameters, origin, noise);
  if (!of_views) out.seen_on = seen_on_of(result.raw, parameters, origin, noise);
  return out;
}

}  // namespace agrisee
