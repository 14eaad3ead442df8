// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Point clouds as PLY files (Turk, "The PLY Polygon File Format", 1994). Meshes: see mesh_file.hpp.
#pragma once

#include <agrisee/io/cloud_file.hpp>

namespace agrisee::io {

/// Read a PLY cloud: ASCII, binary little- or big-endian, properties of any type in any order; see read_cloud.
/// @throws FileError
CloudFile read_ply(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

/// Write a consolidated cloud, binary little-endian and atomically: `float x y z nx ny nz`, `uchar red green blue` (the
/// colour of the fruit, see palette.hpp), `int instance`.
/// @param path of the file
/// @param cloud points (m, world)
/// @param instance one label per point, 0 = no fruit; empty = 0 everywhere
/// @throws InputError when `instance` or the normals are neither empty nor one per point
/// @throws FileError when the file cannot be written
void write_ply(const std::filesystem::path& path, const Cloud& cloud, const Labels& instance = {});

/// Write a merged cloud before any filtering, binary little-endian and atomically: `float x y z`, `int view` (-1 where
/// the cloud does not know its views).
/// @throws InputError when the views are neither empty nor one per point
/// @throws FileError when the file cannot be written
void write_raw_ply(const std::filesystem::path& path, const Cloud& cloud);

}  // namespace agrisee::io
