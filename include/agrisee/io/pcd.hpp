// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads and writes point clouds as PCD files, the format of the Point Cloud Library (version 0.7 and compatible older
/// ones).
#pragma once

#include <agrisee/io/cloud_file.hpp>

namespace agrisee::io {

/// Read a PCD cloud: ASCII, binary or binary_compressed, organized or not, with fields of any type in any order. What
/// is read and what is skipped: see read_cloud. The acquisition pose (VIEWPOINT) is not applied; the points are
/// returned as they are stored.
/// @throws FileError as read_cloud
CloudFile read_pcd(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

/// Write a cloud, binary and atomically: `x y z`, and as far as the cloud has them, `normal_x normal_y normal_z`, `rgb`
/// (measured colors, packed into the bits of a float as the Point Cloud Library does), `label` and `detection`.
/// @param path the file to write
/// @param cloud points (m)
/// @param instance one label per point, or empty
/// @throws InputError when labels, normals, colors or detections are neither empty nor one per point
/// @throws FileError when the file cannot be written
void write_pcd(const std::filesystem::path& path, const Cloud& cloud, const Labels& instance = {});

}  // namespace agrisee::io
