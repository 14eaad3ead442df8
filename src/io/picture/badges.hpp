// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the numbers of the fruit stand in a picture.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace agrisee::io {

/// A disc with a number in it (pixels of the canvas).
struct Badge {
  Eigen::Vector2f center;  ///< where it should stand, or stands
  float radius = 0.0f;     ///< its border included
};

/// A rectangle that is parallel to the axes of the canvas.
struct Rectangle {
  Eigen::Vector2f min, max;
};

/// Places for badges, in the given order: each stands where it should, or at the nearest place, up to a few pixels, at
/// which it covers none of the badges before it and no rectangle of `taken`, and is inside of `within`. A badge for
/// which no such place is found stays where it should stand. Equal arguments give equal places.
std::vector<Badge> place_badges(const std::vector<Badge>& wanted, const std::vector<Rectangle>& taken,
                                const Rectangle& within);

}  // namespace agrisee::io
