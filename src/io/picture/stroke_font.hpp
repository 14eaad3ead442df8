// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A small built-in font of strokes for the captions of pictures.
#pragma once

#include <Eigen/Core>

#include <string_view>
#include <vector>

namespace agrisee::io {

/// A polyline.
using Stroke = std::vector<Eigen::Vector2f>;

/// The strokes of a text that begins at (0, 0) on the baseline, with y down and capitals of height 1. Characters beyond
/// ASCII are drawn as a box.
/// @param text what to draw
/// @param advance set to the x at which the next letter would begin
std::vector<Stroke> text_strokes(std::string_view text, float& advance);

}  // namespace agrisee::io
