// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the open sheets of all leaflets share: their outline, and how their rows of vertices are connected.
#pragma once

#include <agrisee/geometry/mesh.hpp>

namespace agrisee::study {

/// Half width (m) of a pointed, toothed leaflet at row `i` of `rows` from its base.
/// @param width of the leaflet (m)
/// @param tooth every third row is narrower by this factor
double leaf_half_width(int i, int rows, double width, double tooth);

/// Adds the triangles between rows of vertices that stand one after another in a mesh that holds nothing else.
/// @param rows number of bands, one less than rows of vertices
/// @param columns number of vertices in a row
void connect_rows(Mesh& mesh, std::uint32_t rows, std::uint32_t columns);

}  // namespace agrisee::study
