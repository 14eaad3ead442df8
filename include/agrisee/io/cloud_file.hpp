// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Point clouds from files of any of the known formats.
#pragma once

#include <agrisee/core/cloud.hpp>

#include <filesystem>

namespace agrisee::io {

/// What a reader does with points of which a coordinate is NaN or infinite.
enum class NonFinite {
  drop,  ///< leave them out and count them
  keep   ///< keep them, so that an organised cloud stays organised
};

/// What a cloud file holds. Coordinates are single precision, in the file's own frame and unit (metres are expected).
struct CloudFile {
  Cloud cloud;      ///< points; normals and views where the file has them
  Labels instance;  ///< one per point where the file has a property `instance` (or else `label`); otherwise empty
  std::size_t dropped = 0;  ///< number of points left out because they were not finite
  std::size_t width = 0;    ///< points a row of an organised cloud, row by row; all points of any other
  std::size_t height = 0;   ///< rows; 1 when the cloud is not organised
};

/// Read a cloud; PLY (ASCII, binary) and PCD (ASCII, binary, compressed) are told apart by their first bytes.
///
/// Coordinates may be of any numeric type. Normals (`nx ny nz` or `normal_x normal_y normal_z`) are scaled to unit
/// length; unusable ones become zero, which means unknown. Everything else in the file is skipped. Cost: one pass over
/// the file; memory is bounded by its size whatever its header promises.
/// @throws FileError for anything that is not such a file
CloudFile read_cloud(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

}  // namespace agrisee::io
