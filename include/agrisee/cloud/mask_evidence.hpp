// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a detector's masks say of bodies, as the split uses it, without knowing what gives it (fuse/masks.hpp does).
#pragma once

#include <agrisee/cloud/fit.hpp>

#include <functional>
#include <vector>

namespace agrisee {

/// A body that masks propose.
struct MaskBody {
  EllipsoidFit fit;       ///< to the outlines and depths of its masks
  double log_odds = 0.0;  ///< that it is a fruit, by its masks and the depths under them
};

/// What masks say.
struct MaskEvidence {
  std::vector<MaskBody> bodies;  ///< proposals that come before those of the points: of a single view's cloud
  /// Proposals of the masks that none of some bodies explains; they come after those of the points, for what these
  /// leave: where several views have seen a fruit, its points say more of it than its outlines. Empty: none.
  std::function<std::vector<MaskBody>(const std::vector<Ellipsoid>&)> remaining;
  /// How far the masks on the pixels of a body speak for a fruit: log-odds, to be added to what the points say. Empty:
  /// nobody looked.
  std::function<double(const Ellipsoid&)> log_odds;
  double most = 0.0;  ///< the largest magnitude of these
};

}  // namespace agrisee
