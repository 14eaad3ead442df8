// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Evidence for or against bodies from a detector's masks, as segmentation uses it. fuse/masks.hpp computes it.
#pragma once

#include <agrisee/cloud/fit.hpp>

#include <functional>
#include <vector>

namespace agrisee {

/// A body proposed by masks.
struct MaskBody {
  EllipsoidFit fit;       ///< to the outlines and depths of its masks
  double log_odds = 0.0;  ///< of being a fruit, from its masks and the depths under them
};

/// The evidence of all masks.
struct MaskEvidence {
  std::vector<MaskBody> bodies;  ///< proposals that compete before those of the points, for the cloud of a single view
  /// Bodies proposed by the masks that the given bodies do not explain. They come after those of the points and get the
  /// points that these leave: once several views have seen a fruit, its points describe it better than its outlines.
  /// Empty: none.
  std::function<std::vector<MaskBody>(const std::vector<Ellipsoid>&)> remaining;
  /// The log-odds that the masks on a body's pixels add to those of its points. Empty: no detector has looked.
  std::function<double(const Ellipsoid&)> log_odds;
  double most = 0.0;  ///< largest magnitude of log_odds
};

}  // namespace agrisee
