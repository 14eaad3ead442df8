// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads triangle meshes from STL, PLY and OBJ files; writes STL and PLY.
#pragma once

#include <agrisee/geometry/mesh.hpp>
#include <agrisee/io/palette.hpp>

#include <filesystem>

namespace agrisee::io {

/// How the corners of an STL file, which lists three per facet, become vertices.
enum class StlCorners {
  merge,  ///< corners with exactly the same coordinates become one vertex, in order of first appearance
  keep    ///< three separate vertices per facet
};

/// Read a mesh. A file is PLY if it begins like one or is called .ply, OBJ if it is called .obj, and STL otherwise.
///
/// STL may be binary (even if it begins with `solid`) or ASCII; PLY may be ASCII or binary. Polygons of PLY and OBJ
/// files become fans of triangles. A file with coordinates that are not finite or indices out of range is rejected.
/// Degenerate triangles are kept.
/// @throws FileError when the file cannot be read, holds no triangle, or is malformed
Mesh read_mesh(const std::filesystem::path& path, StlCorners corners = StlCorners::merge);

/// Read an STL file, whatever its name. @throws FileError as read_mesh
Mesh read_stl(const std::filesystem::path& path, StlCorners corners = StlCorners::merge);
/// Read an OBJ file, whatever its name. @throws FileError as read_mesh
Mesh read_obj(const std::filesystem::path& path);
/// Read a PLY file, whatever its name. @throws FileError as read_mesh
Mesh read_ply_mesh(const std::filesystem::path& path);

/// Write a binary STL file with facet normals, atomically.
/// @throws InputError when an index is out of range or a vertex not finite  @throws FileError when the file cannot be
/// written
void write_stl(const std::filesystem::path& path, const Mesh& mesh);

/// Write a binary little-endian PLY mesh, atomically.
/// @param path the file to write
/// @param mesh vertices (m) and triangles
/// @param colors one per vertex, or empty
/// @throws InputError when an index is out of range, a vertex not finite, or the colors are not one per vertex
/// @throws FileError when the file cannot be written
void write_ply_mesh(const std::filesystem::path& path, const Mesh& mesh, const std::vector<Rgb>& colors = {});

}  // namespace agrisee::io
