// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads a point cloud from a file of any format that AgriSEE knows: PLY, PCD, NPY, and tables of numbers (XYZ, CSV).
#pragma once

#include <agrisee/core/cloud.hpp>

#include <filesystem>

namespace agrisee::io {

/// What a reader does with points that have a NaN or infinite coordinate.
enum class NonFinite {
  drop,  ///< leave them out and count them
  keep   ///< keep them, so that an organized cloud stays organized
};

/// The contents of a cloud file. Coordinates are single precision, in the frame and unit of the file (metres are
/// expected).
struct CloudFile {
  Cloud cloud;      ///< points; normals, views, colors and detections where the file has them
  Labels instance;  ///< one per point, from the property `instance` or else `label`; empty if the file has neither
  std::size_t dropped = 0;  ///< number of points left out because they were not finite
  std::size_t width = 0;    ///< points per row of an organized cloud; the number of points otherwise
  std::size_t height = 0;   ///< number of rows; 1 when the cloud is not organized
  std::size_t skipped = 0;  ///< columns of an NPY file behind x, y and z, which are not read
};

/// Read a cloud. The first bytes of the file say whether it is PLY (ASCII or binary), PCD (ASCII, binary or
/// compressed), NPY (see read_npy_cloud) or a table of numbers (see read_table_cloud).
///
/// Coordinates may be of any numeric type. Normals (`nx ny nz` or `normal_x normal_y normal_z`) are scaled to unit
/// length; normals without a direction become zero, which means unknown. Measured colors are `measured_red
/// measured_green measured_blue`, else `red green blue` or `r g b`, else `rgb` or `rgba` packed as the Point Cloud
/// Library does. Where the file has `instance`, only `measured_...` is read: other colors paint the instances, as in
/// write_ply. Everything else in the file is skipped.
/// Cost: one pass over the file. Memory is bounded by the size of the file, even when its header claims more points.
/// @throws FileError when the file cannot be read, is of no such format, or is malformed
CloudFile read_cloud(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

/// Read a cloud that numpy.save wrote: an array of N rows of three numbers or more, or of rows by columns by three or
/// more (an organized cloud). The first three are x, y and z, the others are skipped.
/// @throws FileError as read_cloud
CloudFile read_npy_cloud(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

/// Read a cloud from a table of numbers, one point a line, separated by blanks, commas or semicolons.
///
/// The first line may name the columns, also behind `#` or `//`; they then have the meaning that the properties of a
/// PLY file have. Without names the first three numbers of a line are x, y and z, the others are skipped. Other lines
/// that begin with `#` or `//` are comments. An empty coordinate is NaN.
/// @throws FileError as read_cloud; it names the line
CloudFile read_table_cloud(const std::filesystem::path& path, NonFinite non_finite = NonFinite::drop);

}  // namespace agrisee::io
