// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Triangle meshes from and to files: STL, PLY and OBJ.
#pragma once

#include <agrisee/geometry/mesh.hpp>
#include <agrisee/io/palette.hpp>

#include <filesystem>

namespace agrisee::io {

/// What to do with the corners of an STL file, which lists three for every facet.
enum class StlCorners {
  merge,  ///< corners with exactly the same coordinates become one vertex, in order of first appearance
  keep    ///< three vertices a facet
};

/// Read a mesh; the format follows from the first bytes (PLY), else from the extension (.stl, .obj), else from the
/// content.
///
/// STL may be binary (also where it begins with `solid`) or ASCII; PLY as in read_ply; polygons of PLY and OBJ files
/// become fans of triangles. Coordinates are finite and indices in range, or the file is refused. Degenerate triangles
/// stay.
/// @throws FileError when it cannot be read, holds no triangle, or is malformed
Mesh read_mesh(const std::filesystem::path& path, StlCorners corners = StlCorners::merge);

/// Read one format, whatever the file is called. @throws FileError as read_mesh
Mesh read_stl(const std::filesystem::path& path, StlCorners corners = StlCorners::merge);
/// Read an OBJ file, whatever it is called. @throws FileError as read_mesh
Mesh read_obj(const std::filesystem::path& path);
/// Read a PLY file, whatever it is called. @throws FileError as read_mesh
Mesh read_ply_mesh(const std::filesystem::path& path);

/// Write a binary STL file with facet normals, atomically.
/// @throws InputError when an index is out of range or a vertex not finite  @throws FileError when the file cannot be
/// written
void write_stl(const std::filesystem::path& path, const Mesh& mesh);

/// Write a binary little-endian PLY mesh, atomically.
/// @param path of the file
/// @param mesh to be written
/// @param colors one per vertex, or none
/// @throws InputError when an index is out of range, a vertex not finite, or the colours are not one per vertex
/// @throws FileError when the file cannot be written
void write_ply_mesh(const std::filesystem::path& path, const Mesh& mesh, const std::vector<Rgb>& colors = {});

}  // namespace agrisee::io
