// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a detector found in one image: an instance with a class, a score, and a box where it has no mask.
#pragma once

#include <agrisee/core/error.hpp>

#include <optional>
#include <string>

namespace agrisee::sensor {

/// A rectangle of an image in pixels. (u, v) is its upper left corner; pixel 0 reaches from 0 to 1.
struct PixelBox {
  double u = 0.0;       ///< column of its left side
  double v = 0.0;       ///< row of its upper side
  double width = 0.0;   ///< pixels
  double height = 0.0;  ///< pixels
};

/// An instance that a detector found in one image.
struct Detection {
  int instance = 0;             ///< its number in the label image, from 1 to 65535; its own number where it has a box
  double score = 1.0;           ///< the detector's, 0..1
  bool fruit = true;            ///< whether its class is a fruit; else it speaks against one
  std::string name;             ///< of its class, as the detector calls it; may be empty
  std::optional<PixelBox> box;  ///< about it, where the detector gave one
};

}  // namespace agrisee::sensor
