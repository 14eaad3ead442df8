// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Evidence from the sizes of the fruit in one cloud, which are often alike: a leaf that looks like a small part of a
/// fruit may have any size, while a fruit has about the size of the others (empirical Bayes). Cost: linear in the
/// number of bodies.
#pragma once

#include <agrisee/cloud/fit.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace agrisee {

/// A fruit whose size is known.
struct KnownSize {
  Ellipsoid body;       ///< its ellipsoid (m)
  double weight = 1.0;  ///< its probability of being a fruit
};

namespace detail {

constexpr double kNarrowestSizes = 0.15;  ///< least standard deviation of logarithms: errors of fits to little surface
constexpr double kMixedSizes = 0.4;       ///< standard deviation of logarithms from which on sizes say nothing

/// Whether neither body contains the other's center.
inline bool are_apart(const Ellipsoid& a, const Ellipsoid& b) {
  return (a.center - b.center).norm() >= std::max(a.mean_radius(), b.mean_radius());
}

/// The value at which half of the weight is reached. @param values pairs of value and weight, at least one
inline double weighted_median(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  double all = 0.0, sum = 0.0;
  for (const auto& v : values) all += v.second;
  for (const auto& v : values)
    if ((sum += v.second) >= 0.5 * all) return v.first;
  return values.back().first;
}

}  // namespace detail

/// Evidence for or against a fruit from the size of a body, given the sizes of the other fruit.
///
/// The logarithm of a fruit's radius is taken to follow the distribution of the others', blurred by their own standard
/// deviation; with some probability it is of another kind, anywhere in the expected range (the predictive
/// distribution of a Dirichlet process with Gaussian kernels; Escobar & West, 1995). What is no fruit has any radius of
/// the range. The evidence counts less the more the sizes of the others vary, and not at all where their standard
/// deviation exceeds 40 %, as on a truss that shrinks from its shoulder to its tip.
/// @param known fruit; those that overlap the body, such as itself from an earlier round, are left out
/// @param radius_min, radius_max expected range of radii (m)
/// @return difference of log-odds; 0 if there is no other fruit
inline double alike_log_odds(const std::vector<KnownSize>& known, const Ellipsoid& body, double radius_min,
                             double radius_max) {
  constexpr double kNew = 3.0;  // weight of another kind, in fruit
  const double x = std::log(body.mean_radius());
  const auto is_other = [&](const KnownSize& k) { return detail::are_apart(k.body, body); };
  double weights = 0.0, mean = 0.0, variance = 0.0;
  for (const KnownSize& k : known)
    if (is_other(k)) weights += k.weight, mean += k.weight * std::log(k.body.mean_radius());
  if (!(weights > 0.0) || !(radius_max > radius_min)) return 0.0;
  mean /= weights;
  for (const KnownSize& k : known)
    if (is_other(k)) variance += k.weight * std::pow(std::log(k.body.mean_radius()) - mean, 2) / weights;
  const double blur = std::max(detail::kNarrowestSizes, std::sqrt(variance));
  double density = 0.0;  // of the others' logarithms at x, times their weight
  for (const KnownSize& k : known)
    if (is_other(k)) density += k.weight * std::exp(-0.5 * std::pow((x - std::log(k.body.mean_radius())) / blur, 2));
  density /= blur * std::sqrt(2.0 * kPi);
  const double range = std::log(radius_max / radius_min);
  const double agreement = std::max(0.0, 1.0 - variance / (detail::kMixedSizes * detail::kMixedSizes));
  return agreement * std::log((kNew + density * range) / (kNew + weights));
}

/// What the other fruit of a cloud say of the size of one: their weighted median, and how far they spread about it. A
/// few that are far off, as fits to little surface can be, do not count.
/// @param known fruit; those that overlap the body (it itself, found before) are left out
/// @return empty if there are fewer than three others, or if their sizes vary by more than 40 %
inline std::optional<SizePrior> size_prior(const std::vector<KnownSize>& known, const Ellipsoid& body) {
  constexpr std::size_t kFewest = 3;
  constexpr double kNormal = 1.4826;             // standard deviation over median absolute deviation
  std::vector<std::pair<double, double>> sizes;  // logarithms of the radii, and weights
  for (const KnownSize& k : known)
    if (detail::are_apart(k.body, body)) sizes.emplace_back(std::log(k.body.mean_radius()), k.weight);
  if (sizes.size() < kFewest) return std::nullopt;
  const double middle = detail::weighted_median(sizes);
  for (auto& [size, weight] : sizes) size = std::abs(size - middle);
  const double spread = std::max(detail::kNarrowestSizes, kNormal * detail::weighted_median(sizes));
  if (spread > detail::kMixedSizes) return std::nullopt;
  return SizePrior{std::exp(middle), spread};
}

}  // namespace agrisee
