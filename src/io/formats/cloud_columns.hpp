// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Assigns the named columns of a PLY or PCD file to the members of a cloud.
#pragma once

#include <agrisee/io/cloud_file.hpp>

#include <string>

#include "io/formats/columns.hpp"

namespace agrisee::io {

/// A cloud that is being read: sink() says where each column is stored; finish() cleans up what was read.
class CloudColumns {
 public:
  /// @param path the file, for error messages
  /// @param points number of points; the caller has checked that the file is large enough for them
  /// @param names names of the columns of the file
  /// @throws FileError when x, y or z is missing
  CloudColumns(const std::filesystem::path& path, std::size_t points, const std::vector<std::string>& names);

  /// Where the column `name`, of numbers of that type, is stored; an empty Sink for a column that is not used.
  Sink sink(const std::string& name, Scalar type = Scalar::f32);
  /// The cloud that was read. Points that are not finite are dropped or kept; normals have unit length or are zero.
  CloudFile finish(NonFinite non_finite, std::size_t width, std::size_t height);

 private:
  void find_colors(std::size_t points, const std::vector<std::string>& names);
  void finish_colors();

  CloudFile file_;
  std::string channels_[3];            // names of the columns of red, green and blue; empty if there are none
  std::vector<float> channel_values_;  // three a point
  bool whole_channels_ = true;         // they are integers, 0..255
  std::string packed_;                 // name of the column of packed colors; empty if there is none
  std::vector<std::uint32_t> packs_;   // one a point: 0x00rrggbb
  std::string instance_;               // name of the column that holds the instance; empty if there is none
};

}  // namespace agrisee::io
