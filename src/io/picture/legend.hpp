// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The legend of a picture of a scan: the fruit and where they are.
#pragma once

#include <agrisee/result.hpp>

#include <vector>

#include "io/picture/canvas.hpp"

namespace agrisee::io {

/// How many rows the legend has, at most three.
/// @param fruits the fruit that it lists  @param width width of the canvas  @param size height of small capitals
std::size_t legend_rows(const std::vector<Fruit>& fruits, float width, float size);

/// Draw the ids, positions and ripeness of the fruit in columns, as many as have room without overlap, at most six.
/// Where there are too many fruit, the last entry says how many more.
/// @param canvas to draw on  @param fruits to list  @param top upper edge of the legend
/// @param size height of small capitals
void draw_legend(Canvas& canvas, const std::vector<Fruit>& fruits, int top, float size);

}  // namespace agrisee::io
