// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The checks that all mesh readers and writers share.
#pragma once

#include <agrisee/geometry/mesh.hpp>

#include <filesystem>

namespace agrisee::io {

/// Check a mesh that was read from `path`. @throws FileError if it has no triangle, or a vertex that is not finite
void check_mesh(const std::filesystem::path& path, const Mesh& mesh);
/// Check a mesh before it is written. @throws InputError if it has an index out of range, or a vertex that is not
/// finite
void check_writable(const Mesh& mesh);

}  // namespace agrisee::io
