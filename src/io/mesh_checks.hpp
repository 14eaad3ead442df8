// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What every mesh reader and writer checks.
#pragma once

#include <agrisee/geometry/mesh.hpp>

#include <filesystem>

namespace agrisee::io {

/// @throws FileError when a mesh that was read has no triangle or a vertex that is not finite
void check_mesh(const std::filesystem::path& path, const Mesh& mesh);
/// @throws InputError when a mesh to be written has an index out of range or a vertex that is not finite
void check_writable(const Mesh& mesh);

}  // namespace agrisee::io
