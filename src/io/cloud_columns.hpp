// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The columns of a cloud file by name: what PLY and PCD have in common.
#pragma once

#include <agrisee/io/cloud_file.hpp>

#include <string>

#include "columns.hpp"

namespace agrisee::io {

/// A cloud in the making: it says where the column of a name goes, then cleans up what came in.
class CloudColumns {
 public:
  /// @param points number of points, already known to fit the file
  /// @param names columns of the file
  /// @throws FileError when x, y or z is missing
  CloudColumns(const std::filesystem::path& path, std::size_t points, const std::vector<std::string>& names);

  /// Where a column goes; false where it is of no use.
  Sink sink(const std::string& name);
  /// The cloud, points that are not finite dropped or kept, normals of unit length or zero.
  CloudFile finish(NonFinite non_finite, std::size_t width, std::size_t height);

 private:
  CloudFile file_;
  std::string instance_;  // name of the column that holds it
};

}  // namespace agrisee::io
