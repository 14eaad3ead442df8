// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The detections of an image: each is an instance with a class, a score, and a box if it has no mask.
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
  int instance = 0;             ///< number in the label image, 1 to 65535; a box without a mask has its own number
  double score = 1.0;           ///< the detector's confidence, 0..1
  bool fruit = true;            ///< whether the class is a fruit; other classes count against a fruit
  std::string name;             ///< the detector's name of the class; may be empty
  std::optional<PixelBox> box;  ///< bounding box, if the detector gave one
};

}  // namespace agrisee::sensor
