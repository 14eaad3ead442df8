// SPDX-License-Identifier: BSD-3-Clause
// Structs with the members of ROS messages, where no ROS is installed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mock {

struct PointField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
  std::uint32_t count = 0;
};
struct PointCloud2 {
  std::uint32_t height = 0, width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;
  std::vector<std::uint8_t> data;
  bool is_dense = false;
};
struct Image {
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;
  std::vector<std::uint8_t> data;
};
struct Roi {
  std::uint32_t x_offset = 0, y_offset = 0, height = 0, width = 0;
};
/// As in ROS 2; ROS 1 writes D, K and P.
struct CameraInfo {
  std::uint32_t height = 0, width = 0;
  std::string distortion_model = "plumb_bob";
  std::vector<double> d;
  std::array<double, 9> k{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;
  Roi roi;
};
struct CameraInfo1 {
  std::uint32_t height = 0, width = 0;
  std::string distortion_model = "plumb_bob";
  std::vector<double> D;
  std::array<double, 9> K{};
  std::array<double, 12> P{};
  std::uint32_t binning_x = 0, binning_y = 0;
  Roi roi;
};

}  // namespace mock
