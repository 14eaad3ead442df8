// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What goes into the competition of bodies for the points of a cloud (bodies.hpp), and what comes out. Metres.
#pragma once

#include <agrisee/cloud/body_counts.hpp>
#include <agrisee/cloud/fit.hpp>

#include <cstddef>
#include <optional>
#include <string>

namespace agrisee {

/// A proposed body, and the stage that proposed it.
struct BodyCandidate {
  Ellipsoid body;        ///< first guess
  std::string found_by;  ///< the stage that proposed it; see Fruit::found_by
  /// The count to raise if its points do not support it, for example because they suggest an unexpected radius.
  std::size_t BodyCounts::*doubt = nullptr;
  std::optional<EllipsoidFit> fit = {};      ///< fit to the present points, if already known
  std::optional<double> mask_log_odds = {};  ///< set if masks proposed it; `fit` is then that of their outlines
};

/// A body that won its points.
struct FoundBody {
  EllipsoidFit fit;         ///< the body with its uncertainty
  std::string found_by;     ///< the stage that found it; see Fruit::found_by
  double coverage = 0.0;    ///< share of its surface covered by its points
  double confidence = 0.0;  ///< probability that it is a fruit, see detail::fruit_probability
  bool by_mask = false;     ///< `fit` is that of a mask's outline, because few points were seen
  double prior = 0.0;       ///< log-odds by the masks and by the sizes of the other fruit, part of `confidence`
};

}  // namespace agrisee
