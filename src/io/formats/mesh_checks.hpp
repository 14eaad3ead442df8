// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the mesh readers and writers share: checks, and the coordinates of a vertex in a text file.
#pragma once

#include <agrisee/geometry/mesh.hpp>

#include <filesystem>
#include <string>
#include <string_view>

#include "io/formats/text.hpp"

namespace agrisee::io {

/// Check a mesh that was read from `path`. @throws FileError if it has no triangle, or a vertex that is not finite
void check_mesh(const std::filesystem::path& path, const Mesh& mesh);
/// Check a mesh before it is written. @throws InputError if it has an index out of range, or a vertex that is not
/// finite
void check_writable(const Mesh& mesh);

/// The vertex whose coordinates come next in a line; the line then begins behind them.
/// @param bad bad(what) throws with what is wrong
template <typename Bad>
Eigen::Vector3f next_vertex(std::string_view& line, Bad&& bad) {
  Eigen::Vector3f vertex;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view text = next_word(line);
    const auto value = to_number(text);
    if (!value) bad(text.empty() ? "a vertex with fewer than 3 coordinates" : excerpt(text) + " is not a number");
    vertex[axis] = static_cast<float>(*value);
  }
  return vertex;
}

}  // namespace agrisee::io
