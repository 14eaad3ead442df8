// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A small built-in font of strokes for captions.
#pragma once

#include <Eigen/Core>

#include <string_view>
#include <vector>

namespace agrisee::io {

/// A run of connected points.
using Stroke = std::vector<Eigen::Vector2f>;

/// The strokes of a text whose first letter stands at (0, 0), baseline at y = 0, y down, capitals 1 high. Characters
/// beyond ASCII show as a box.
/// @param advance set to where a next letter would begin
std::vector<Stroke> text_strokes(std::string_view text, float& advance);

}  // namespace agrisee::io
