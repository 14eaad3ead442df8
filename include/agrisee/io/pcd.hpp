// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Point clouds as PCD files (the Point Cloud Library's format, version 0.7 and the older ones that differ in nothing).
#pragma once

#include <agrisee/io/cloud_file.hpp>

namespace agrisee::io {

/// Read a PCD cloud: ASCII, binary or binary_compressed, organised or not, fields of any type in any order; see
/// read_cloud. The acquisition pose (VIEWPOINT) is not applied: points are returned as they are stored.
/// @throws FileError
CloudFile read_pcd(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

}  // namespace agrisee::io
