// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The search for a fruit's closed surface: fits from several first guesses and with several numbers of lobes. The fit
/// with the most evidence is kept, and drawn back where a leaf has added to it. Metres, any frame.
#pragma once

#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/surface_fit.hpp>
#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/cloud.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace agrisee::detail {

/// Standard deviation of a point, relative to the radius, that evidence for or against the ellipsoid assumes at least.
constexpr double kEvidenceNoise = 0.01;

/// The direction in which most points of the fruit stand out from its ellipsoid, as at the neck of a pear; empty if few
/// do.
template <typename S>
std::optional<Eigen::Vector3d> neck_of(const PointCloud<S>& cloud, const Indices& own, const Ellipsoid& body) {
  constexpr double kOut = 0.04;          // of the radius
  constexpr double kLeastShare = 0.02;   // of the points
  constexpr double kTogether = 0.8;      // cosine of the angle between points of one neck
  constexpr std::size_t kPoints = 1000;  // that are looked at
  std::vector<Eigen::Vector3d> outside;
  const std::size_t used = std::min(own.size(), kPoints);
  for (std::size_t k = 0; k < used; ++k) {
    const auto i = static_cast<std::size_t>(own[k * own.size() / used]);
    const Eigen::Vector3d p = cloud.points[i].template cast<double>();
    if (body.distance(p) > kOut * body.mean_radius()) outside.push_back((p - body.center).normalized());
  }
  Eigen::Vector3d neck = Eigen::Vector3d::Zero();
  std::size_t most = static_cast<std::size_t>(kLeastShare * static_cast<double>(used));
  for (const Eigen::Vector3d& a : outside) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t count = 0;
    for (const Eigen::Vector3d& b : outside)
      if (a.dot(b) > kTogether) sum += b, ++count;
    if (count > most) most = count, neck = sum;
  }
  if (neck.isZero()) return std::nullopt;
  return neck.normalized();
}

/// First guesses of a fruit's surface: the ellipsoid with the given axis and with each of its own. The points at the
/// stem may be those of a calyx that stands out, and the ellipsoid may have followed them; the second guess is nearly a
/// sphere, and these points stay out of it until the sides have shaped the surface. Where the ellipsoid follows the
/// bulb of a pear, only the neck tells the axis.
template <typename S>
std::vector<SurfaceFit::Start> first_guesses(const PointCloud<S>& cloud, const Indices& own, const Ellipsoid& body,
                                             const Eigen::Vector3d& axis) {
  constexpr double kTop = 0.3, kNearlySphere = 0.02, kAlike = 0.5;
  constexpr double kOther = 0.9;  // cosine of the least angle between axes that are both tried
  std::vector<SurfaceFit::Start> out{{body, axis}};
  Indices below;
  for (const Index i : own) {
    const Eigen::Vector3d q = cloud.points[static_cast<std::size_t>(i)].template cast<double>() - body.center;
    if (q.dot(axis) <= kTop * q.norm() * axis.norm()) below.push_back(i);
  }
  FitParameters rounder;
  rounder.shape_prior = kNearlySphere;
  const auto sphere = sphere_from_normals(cloud, below);
  const bool usable = sphere && std::abs(std::log(sphere->radius / body.mean_radius())) < kAlike;
  const auto fit = fit_ellipsoid(cloud, below, usable ? Ellipsoid(*sphere) : body, rounder);
  out.push_back({fit ? fit->body : body, axis, kTop});
  if (const auto neck = neck_of(cloud, own, body); neck && std::abs(neck->dot(axis)) < kOther)
    out.push_back({body, *neck});
  const Eigen::Matrix3d axes = semi_axes(body).second;
  for (int k = 0; k < 3; ++k)
    if (std::abs(axes.col(k).dot(axis)) < kOther) out.push_back({body, axes.col(k)});
  return out;
}

/// Numbers of lobes that are tried; 0 is a body of revolution.
constexpr std::array<int, 8> kLobes = {0, 3, 4, 5, 6, 7, 8, 9};

/// Relative distances outside the surface beyond which points lose weight, step by step.
constexpr std::array<double, 4> kGates = {0.15, 0.08, 0.05, 0.04};

/// The gates of step `k`, the last for all that follow. Points inside may lie farther off.
inline SurfaceFit::Gates gates(std::size_t k, bool join = true) {
  const double outside = kGates[std::min(k, kGates.size() - 1)];
  return {outside, 1.5 * outside, false, join};
}
inline SurfaceFit::Gates last_gates() { return gates(kGates.size() - 1); }

/// A fit of the model number `model`.
struct FittedSurface {
  SurfaceFit fit;
  std::size_t model;
  double evidence;  ///< for the fit (nats)
};

/// Evidence (nats) for a fit by the fruit's points, less what contradicts it.
inline double evidence_less_contradictions(const SurfaceFit& fit, const SurfaceModel& model) {
  constexpr double kFar = 0.5;             // points farther off than this do not tell fits apart
  constexpr double kContradiction = 20.0;  // nats
  return fit.evidence(model, fit.radial_bins(fit.plain_weights(kFar)), kEvidenceNoise) -
         kContradiction * static_cast<double>(fit.contradictions());
}

/// Fit from one first guess: a body of revolution, then the model for which there is most evidence.
/// @param models one for each of kLobes
/// @return empty if the points do not determine it
inline std::optional<FittedSurface> fit_from(const SurfaceFit::Start& start, const SurfaceFit::Samples& samples,
                                             const std::vector<SurfaceModel>& models,
                                             const ClosedSurfaceParameters& parameters) {
  constexpr std::size_t kSteps = 4;  // as a body of revolution, then with its lobes
  SurfaceFit fit(samples, start, models[0], parameters);
  for (std::size_t k = 0; k < kSteps; ++k)
    if (!fit.step(models[0], gates(k, k >= 2))) return std::nullopt;
  const std::vector<double> plain = fit.plain_weights(0.2);
  const std::vector<RadialBin> bins = fit.radial_bins(plain);
  if (bins.empty()) return std::nullopt;
  std::size_t model = 0;
  double largest = 0.0;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const double evidence = fit.evidence_for(models[m], models[0], bins, 0.006);
    if (m > 0 && !(evidence > largest)) continue;
    largest = evidence;
    model = m;
  }
  fit.change(models[model], models[0]);
  if (model > 0) fit.set_weights(plain);
  for (std::size_t k = 0; k < kSteps; ++k) {
    if (k == 1) fit.open_top();
    if (!fit.step(models[model], gates(k + 1))) return std::nullopt;
  }
  const double evidence = evidence_less_contradictions(fit, models[model]);
  return FittedSurface{std::move(fit), model, evidence};
}

/// A fit without what other things have added to the fruit. A leaf that lies on it looks like a neck, and the fruit's
/// points beside the leaf then lie deep inside that neck. Steps that count them draw the surface back to them, and the
/// leaf's points lose their weight.
/// @return the given fit if nothing contradicts it, or if there is more evidence for it
inline FittedSurface without_neighbors(FittedSurface fitted, const SurfaceModel& model) {
  if (fitted.fit.contradictions() == 0) return fitted;
  constexpr int kDraw = 8, kSettle = 2;  // steps
  constexpr double kDeepInside = 0.32;   // relative; more than the depth of a contradiction
  SurfaceFit fit = fitted.fit;
  for (int k = 0; k < kDraw; ++k)
    if (!fit.step(model, {kGates.back(), kDeepInside, true})) return fitted;
  for (int k = 0; k < kSettle; ++k)
    if (!fit.step(model, last_gates())) return fitted;
  const double evidence = evidence_less_contradictions(fit, model);
  if (!(evidence > fitted.evidence)) return fitted;
  return {std::move(fit), fitted.model, evidence};
}

/// The best of the fits from several first guesses; empty if none succeeds.
inline std::optional<FittedSurface> best_fit(const std::vector<SurfaceFit::Start>& starts,
                                             const SurfaceFit::Samples& samples,
                                             const std::vector<SurfaceModel>& models,
                                             const ClosedSurfaceParameters& parameters) {
  constexpr double kGoodFit = 0.006;  // misfit of a fit after which no other start is tried
  constexpr double kClearly = 10.0;   // nats by which the guess without the points at the stem has to be better
  std::optional<FittedSurface> best;
  for (const SurfaceFit::Start& start : starts) {
    throw_if_cancelled();
    auto fitted = fit_from(start, samples, models, parameters);
    if (!fitted) continue;
    if (best && !(fitted->evidence > best->evidence + (start.top < 1.0 ? kClearly : 0.0))) continue;
    best.emplace(std::move(*fitted));
    if (best->fit.misfit() < kGoodFit && best->fit.contradictions() == 0) break;
  }
  return best;
}

}  // namespace agrisee::detail
