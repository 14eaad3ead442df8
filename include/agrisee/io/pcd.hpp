// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads point clouds from PCD files, the format of the Point Cloud Library (version 0.7 and compatible older ones).
#pragma once

#include <agrisee/io/cloud_file.hpp>

namespace agrisee::io {

/// Read a PCD cloud: ASCII, binary or binary_compressed, organised or not, with fields of any type in any order. What
/// is read and what is skipped: see read_cloud. The acquisition pose (VIEWPOINT) is not applied; the points are
/// returned as they are stored.
/// @throws FileError as read_cloud
CloudFile read_pcd(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

}  // namespace agrisee::io
