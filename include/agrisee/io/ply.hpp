// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads and writes point clouds as PLY files (Turk, "The PLY Polygon File Format", 1994). For meshes see
/// mesh_file.hpp.
#pragma once

#include <agrisee/io/cloud_file.hpp>

namespace agrisee::io {

/// Read a PLY cloud: ASCII or binary, little- or big-endian, with properties of any type in any order. What is read and
/// what is skipped: see read_cloud.
/// @throws FileError as read_cloud
CloudFile read_ply(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

/// Write a consolidated cloud, binary little-endian and atomically: `float x y z nx ny nz`, `uchar red green blue` (the
/// color of the fruit, see palette.hpp), `int instance`; then, where the cloud has them, `uchar measured_red
/// measured_green measured_blue` and `int detection`.
/// @param path the file to write
/// @param cloud points (m, world frame)
/// @param instance one label per point, 0 for no fruit; empty means 0 everywhere
/// @throws InputError when `instance`, the normals, colors or detections are neither empty nor one per point
/// @throws FileError when the file cannot be written
void write_ply(const std::filesystem::path& path, const Cloud& cloud, const Labels& instance = {});

/// Write the merged cloud as it was before filtering, binary little-endian and atomically: `float x y z` and `int
/// view`, the view that each point came from (-1 if the cloud has no views).
/// @throws InputError when the views are neither empty nor one per point
/// @throws FileError when the file cannot be written
void write_raw_ply(const std::filesystem::path& path, const Cloud& cloud);

}  // namespace agrisee::io
