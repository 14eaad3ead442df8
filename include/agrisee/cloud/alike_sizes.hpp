// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Evidence from the sizes of the fruit in one cloud, which are often alike: a leaf that looks like a small part of a
/// fruit may have any size, while a fruit has about the size of the others (empirical Bayes). Cost: linear in the
/// number of bodies.
#pragma once

#include <agrisee/cloud/fit.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace agrisee {

/// A fruit whose size is known.
struct KnownSize {
  Ellipsoid body;       ///< its ellipsoid (m)
  double weight = 1.0;  ///< its probability of being a fruit
};

/// Evidence for or against a fruit from the size of a body, given the sizes of the other fruit.
///
/// The logarithm of a fruit's radius is taken to follow the distribution of the others', blurred by their own standard
/// deviation; with some probability it is of another kind, anywhere in the expected range (the predictive
/// distribution of a Dirichlet process with Gaussian kernels; Escobar & West, 1995). What is no fruit has any radius of
/// the range. The evidence counts less the more the sizes of the others vary, and not at all where their standard
/// deviation exceeds 40 %, as on a truss that shrinks from its shoulder to its tip.
/// @param known fruit; those that overlap the body (it itself, found before) are left out
/// @param radius_min, radius_max expected range of radii (m)
/// @return difference of log-odds; 0 if there is no other fruit
inline double alike_log_odds(const std::vector<KnownSize>& known, const Ellipsoid& body, double radius_min,
                             double radius_max) {
  constexpr double kNew = 3.0;         // weight of another kind, in fruit
  constexpr double kNarrowest = 0.15;  // least blur: errors of fits to little surface
  constexpr double kMixed = 0.4;       // standard deviation of the logarithms from which on sizes say nothing
  const double radius = body.mean_radius(), x = std::log(radius);
  const auto is_other = [&](const KnownSize& k) {
    return (k.body.center - body.center).norm() >= std::max(radius, k.body.mean_radius());
  };
  double weights = 0.0, mean = 0.0, variance = 0.0;
  for (const KnownSize& k : known)
    if (is_other(k)) weights += k.weight, mean += k.weight * std::log(k.body.mean_radius());
  if (!(weights > 0.0) || !(radius_max > radius_min)) return 0.0;
  mean /= weights;
  for (const KnownSize& k : known)
    if (is_other(k)) variance += k.weight * std::pow(std::log(k.body.mean_radius()) - mean, 2) / weights;
  const double blur = std::max(kNarrowest, std::sqrt(variance));
  double density = 0.0;  // of the others' logarithms at x, times their weight
  for (const KnownSize& k : known)
    if (is_other(k)) density += k.weight * std::exp(-0.5 * std::pow((x - std::log(k.body.mean_radius())) / blur, 2));
  density /= blur * std::sqrt(2.0 * kPi);
  const double range = std::log(radius_max / radius_min);
  const double agreement = std::max(0.0, 1.0 - variance / (kMixed * kMixed));
  return agreement * std::log((kNew + density * range) / (kNew + weights));
}

}  // namespace agrisee
