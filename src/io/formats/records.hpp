// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes binary records, one a point.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/io/files.hpp>

#include <algorithm>
#include <vector>

#include "io/formats/columns.hpp"

namespace agrisee::io {

/// Write records block by block. pack(at, i) writes record i to `at` and moves `at` behind it.
template <typename Pack>
void write_records(AtomicFile& file, std::size_t records, std::size_t record_size, Pack&& pack) {
  constexpr std::size_t kBlock = 4096;
  std::vector<char> block(kBlock * record_size);
  for (std::size_t begin = 0; begin < records; begin += kBlock) {
    const std::size_t end = std::min(records, begin + kBlock);
    char* at = block.data();
    for (std::size_t i = begin; i < end; ++i) pack(at, i);
    file.write(block.data(), (end - begin) * record_size);
  }
}

/// Copy a vector's three numbers to `at`, and move `at` behind them.
inline void put_vector(char*& at, const Eigen::Vector3f& v) {
  put(at, v.x());
  put(at, v.y());
  put(at, v.z());
}

/// @throws InputError when the colors or detections of a cloud are neither empty nor one per point
inline void check_channels(const Cloud& cloud) {
  check_input(cloud.colors.empty() || cloud.colors.size() == cloud.size(), "write a cloud: not one color per point");
  check_input(cloud.instances.empty() || cloud.instances.size() == cloud.size(),
              "write a cloud: not one detection per point");
}

}  // namespace agrisee::io
