// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How likely a body is a fruit, by the evidence for and against it, and whether it has the shape of one. Metres.
#pragma once

#include <agrisee/cloud/body_verdict.hpp>
#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/parameters.hpp>
#include <agrisee/core/log_odds.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::detail {

/// Whether a body is longer than any fruit. Posts that end on both sides are, and bottles; cucumbers up to 3.2 times as
/// long as wide are not, by the default `min_roundness`.
/// @param radii semi-axes (m), the largest first
inline bool too_long(const Eigen::Vector3d& radii, const BodyParameters& parameters) {
  constexpr double kLongest = 0.28;  // of min_roundness: (shortest / longest)^2, the roundness of an ellipsoid's middle
  constexpr double kLargest = 1.4;   // longest semi-axis, in largest expected radii
  return radii[2] * radii[2] < kLongest * parameters.min_roundness * radii[0] * radii[0] ||
         radii[0] > kLargest * parameters.radius_max;
}

/// Whether a body is round enough for a fruit. One that several views show from end to end may be long, but its ends
/// have to be round: an ellipsoid's roundness is (shortest / longest semi-axis)^2, a capsule's is as large, and that of
/// a piece of pipe is 0.
inline bool round_enough(const Verdict& v, const Ellipsoid& body, const BodyParameters& parameters) {
  constexpr double kRoundEnds = 0.3;  // of the ellipsoid's; long fruit in simulated scans has at least 0.9
  if (v.roundness >= parameters.min_roundness) return true;
  if (v.seen_on || !v.closed()) return false;
  const Eigen::Vector3d radii = semi_axes(body).first;
  return !too_long(radii, parameters) && v.roundness * radii[0] * radii[0] >= kRoundEnds * radii[2] * radii[2];
}

/// A larger misfit of a body to its points, as a share of its radius, changes nothing.
constexpr double kMostMisfit = 0.08;

/// More roundness changes nothing.
constexpr double kRoundEnough = 0.8;

/// What counts differently on small bodies, and where normals are noisy.
struct SizedEvidence {
  double points;   ///< on the surface, as many as a body of usual size would have
  double spread;   ///< of the normals, without what noise and the size of the body explain
  double clutter;  ///< without the body's own points whose normals are off through noise
  double by_size;  ///< log-odds for a fruit by the roundness of a small body, and against one that is too small
};

/// The evidence of a body, seen in the light of its size and of the noise.
/// @param radius of the body (m)
inline SizedEvidence sized_evidence(const Verdict& v, double radius, const BodyParameters& parameters) {
  constexpr double kMostPoints = 1500.0;           // more change nothing
  constexpr double kSmall = 2.0, kSmallest = 2.5;  // usual radii over the body's; smaller ones count as these
  constexpr double kWider = 0.6, kSooner = 0.25;   // how these change at much noise: as a share, and by
  constexpr double kPatch = 0.11, kRounder = 5.5;  // of the usual radius; weight
  // The same share of a smaller surface has fewer points. Where several views agree on a body they count as on one of
  // usual size, whatever sizes are expected; in a single view scraps of leaves are small, too.
  const double larger = v.seen_on ? 1.0 : std::max(1.0, parameters.usual_radius / radius);
  const double points = std::min(larger * larger * static_cast<double>(v.support), kMostPoints);
  // The patches that normals are fitted to are wide against small bodies, and wider at much noise, so their normals
  // spread more. How round such a body is counts more instead. In one or two views scraps would profit from noise.
  const bool several = !v.seen_on && parameters.several_views();
  const double noisy = several ? parameters.share_of_much_noise() : 0.0;
  const double small = kSmall / (1.0 + kWider * noisy);
  const double smaller = std::clamp(larger, small, kSmallest - kSooner * noisy);
  const double blurred = kPatch * kPatch * (smaller * smaller - small * small);
  const double spread = std::sqrt(
      std::max(0.0, v.normal_spread * v.normal_spread - parameters.normal_noise * parameters.normal_noise - blurred));
  // At much noise also points of the body's own have such normals, but not most of them.
  constexpr double kMostTurned = 0.4;
  const double clutter = v.clutter - noisy * std::min(v.turned, kMostTurned);
  const double rounder = kRounder * (smaller - small) * (std::min(v.roundness, kRoundEnough) - 0.5);
  constexpr double kTooSmall = 40.0;  // below the smallest expected radius all this makes scraps likely
  const double too_small = std::max(0.0, parameters.radius_min / radius - 1.0);
  return {points, spread, clutter, rounder - kTooSmall * noisy * too_small};
}

/// Log-odds for a fruit by what a single view shows of the place: returns on the surface, or deeper ones, or none.
inline double single_view_evidence(double seen_on) {
  constexpr double kSingleView = -0.4, kSeenOn = 2.8;
  return kSingleView + kSeenOn * std::log(seen_on);
}

/// Log-odds for a fruit by what only several views show: that a stump is a cylinder, that a box has corners, and that a
/// pot goes on below its rim.
/// @param spread of the normals, see SizedEvidence
inline double several_views_evidence(const Verdict& v, double spread, const BodyParameters& parameters) {
  constexpr double kClosed = 0.5, kCornered = 1.5, kWidest = 0.3;
  constexpr double kBeyond = 100.0, kMostBeyond = 0.01, kRim = 0.07, kMostRim = 0.03;
  return -parameters.ridge *
             ((v.closed() ? kClosed : 1.0) * v.flatness() + kCornered * std::max(0.0, spread - kWidest)) -
         kBeyond * (std::clamp(v.beyond - kGoesOn, 0.0, kMostBeyond) + std::clamp(v.beyond - kRim, 0.0, kMostRim));
}

/// The probability (0 to 1) that a body is a fruit, by logistic regression on its evidence. On leaves and stems normals
/// spread, other points lie close to the body, and few points support it.
///
/// The weights were fitted to 1,700 bodies: in 33 simulated scenes (plants of six kinds and bare trusses, one to 14
/// views, four noise models) and in three frames of real apple trees; docs/segmentation.md shows how well they hold.
/// The terms of a single view, and the weight of BodyParameters::alike, were fitted to 800 bodies in 32 simulated views
/// of orchards (Azure Kinect, shade and sun, 0.6 to 1.5 m) and 250 in real frames. How the points of small bodies count
/// was found in 36 more scenes. Simulated and real frames agree in the weights, but not in the constant: the one here
/// is between those of the real frames; frames in the sun would need a larger one. What roundness below 0.5 and normals
/// that spread more than those of all fruit count in several views was found in 240 scans of 80 plants: of 1,700 fruit
/// 8 are less round, and 5 spread more; stumps, trunks and pipes have 0.35 to 0.5, and boxes spread by 0.33 to 0.4. The
/// terms of bodies below half the usual radius in several views were chosen in 136 scans with 706 such fruit, those of
/// noisy normals in 266 scans of 133 plants.
/// @param prior log-odds from elsewhere, which are added (MaskEvidence::log_odds)
inline double fruit_probability(const Verdict& v, const EllipsoidFit& fit, const BodyParameters& parameters,
                                double prior = 0.0) {
  if (v.support == 0 || !(v.coverage > 0.0)) return 0.0;
  constexpr double kLarge = 0.5;  // of the largest radius; more changes nothing
  constexpr double kTooLong = 30.0;
  const double radius = fit.body.mean_radius();
  const SizedEvidence sized = sized_evidence(v, radius, parameters);
  const double evidence = 3.95 - 14.4 * sized.spread - 2.32 * std::log1p(sized.clutter) -
                          29.4 * std::min(fit.rms / radius, kMostMisfit) + 1.05 * std::log(sized.points / 50.0) +
                          1.55 * std::min(v.roundness, kRoundEnough) - 3.69 * v.through_share() -
                          5.65 * v.inside / v.coverage + 1.7 * std::min(radius / parameters.radius_max, kLarge);
  const double view =
      v.seen_on ? single_view_evidence(*v.seen_on) : several_views_evidence(v, sized.spread, parameters);
  const double too_long = std::max(0.0, fit.body.mean_semi_axis() / parameters.radius_max - 1.0);
  return from_log_odds(evidence + sized.by_size + view - kTooLong * too_long + prior);
}

/// By how much the sensor's noise explains the misfit of a body to its points, as a share of the radius.
inline double explained_misfit(const EllipsoidFit& fit, const BodyParameters& parameters) {
  constexpr double kMostNoise = 0.045, kMost = 0.02;  // shares of the radius: about small bodies noise proves nothing
  const double radius = fit.body.mean_radius(), misfit = fit.rms / radius;
  const double noise = std::min(parameters.point_noise / radius, kMostNoise);
  const double own = std::sqrt(std::max(0.0, misfit * misfit - noise * noise));
  return std::min(std::min(misfit, kMostMisfit) - std::min(own, kMostMisfit), kMost);
}

/// The probability (0 to 1) that a body of a single view is a fruit, when it has its points and its last fit.
///
/// Its log-odds are the mean of those by which it won the points, and those of the verdict on the last fit. Misfit that
/// the sensor's noise explains does not count against it, but a body counts less the more its size is within the noise:
/// anything small looks round then. Nothing is believed where the noise turns normals at random. Sight lines through it
/// count more, as all are of one frame. The weights were fitted to 3,200 bodies: in 540 simulated views (L515 and Azure
/// Kinect, shade and sun, 0.4 to 1.2 m) and in three real frames; that of the noise to 3,800 in 460 more views (also
/// D405, 0.3 to 0.8 m). The constant, and how roundness and random normals count, were fitted to 6,300 bodies in 1,260
/// simulated views of 84 plants, and to 1,700 in two real frames, each mirrored, turned, scaled, thinned, or with more
/// noise. See docs/segmentation.md for what they bring.
/// @param won probability by which the body won its points
/// @param v verdict on the last fit by all points, taken or not
/// @param prior as of fruit_probability
inline double settled_probability(double won, const Verdict& v, const EllipsoidFit& fit,
                                  const BodyParameters& parameters, double prior) {
  constexpr double kExplained = 75.0, kThrough = 12.0, kRounder = 2.5, kOffset = -1.45;
  constexpr double kRandom = 30.0, kMostNormalNoise = 0.3;  // rad; white noise of 10 mm causes 0.4
  constexpr double kBlurred = 20.0, kSharp = 0.055;         // noise up to this share of the radius does not count
  const double now = fruit_probability(v, fit, parameters, prior);
  if (!(now > 0.0)) return 0.0;
  const double blurred = std::max(0.0, parameters.point_noise / fit.body.mean_radius() - kSharp);
  const double random = std::max(0.0, parameters.normal_noise - kMostNormalNoise);
  return from_log_odds(0.5 * (log_odds(won) + log_odds(now)) + kExplained * explained_misfit(fit, parameters) +
                       kRounder * std::min(v.roundness, kRoundEnough) - kThrough * v.through_share() -
                       kBlurred * blurred - kRandom * random + kOffset);
}

}  // namespace agrisee::detail
