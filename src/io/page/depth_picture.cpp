// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/error.hpp>
#include <agrisee/io/depth_picture.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "io/picture/gray_png.hpp"

namespace agrisee::io {
namespace {

/// The nearest return (m) of each block of `block` by `block` pixels, row by row; 0 where none of its pixels returned.
std::vector<float> nearest_of_blocks(const sensor::DepthFrame& frame, int block, int width, int height) {
  std::vector<float> nearest(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0f);
  for (int v = 0; v < frame.intrinsics.height; ++v) {
    float* const row = nearest.data() + static_cast<std::size_t>(v / block) * static_cast<std::size_t>(width);
    for (int u = 0; u < frame.intrinsics.width; ++u) {
      const float z = frame.at(u, v);
      float& best = row[u / block];
      if (sensor::DepthFrame::valid(z) && (best == 0.0f || z < best)) best = z;
    }
  }
  return nearest;
}

/// The range of the depths (m) without the first and last half percent; zeros, which are no return, do not count.
std::pair<double, double> range_of(std::vector<float> depths) {
  depths.erase(std::remove(depths.begin(), depths.end(), 0.0f), depths.end());
  if (depths.empty()) return {0.0, 0.0};
  const auto cut = static_cast<std::ptrdiff_t>(depths.size() / 200);
  const auto at = [&](std::vector<float>::iterator place) {
    std::nth_element(depths.begin(), place, depths.end());
    return double(*place);
  };
  const double nearest = at(depths.begin() + cut);
  return {nearest, at(depths.end() - 1 - cut)};
}

}  // namespace

DepthPicture depth_picture(const sensor::DepthFrame& frame, int longest_side) {
  sensor::check(frame);
  check_parameter(longest_side >= 1, "longest_side", "1 or more", longest_side);
  const sensor::Intrinsics& k = frame.intrinsics;
  const int block = (std::max(k.width, k.height) - 1) / longest_side + 1;
  DepthPicture picture;
  picture.width = (k.width - 1) / block + 1;
  picture.height = (k.height - 1) / block + 1;
  const std::vector<float> depths = nearest_of_blocks(frame, block, picture.width, picture.height);
  std::tie(picture.nearest, picture.farthest) = range_of(depths);
  std::vector<std::uint8_t> levels(depths.size(), 0);
  const double low = 1.0 / picture.farthest, range = 1.0 / picture.nearest - low;  // not used without a return
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (depths[i] == 0.0f) continue;
    const double share = range > 0.0 ? (1.0 / double(depths[i]) - low) / range : 1.0;
    levels[i] = static_cast<std::uint8_t>(1 + std::lround(254.0 * std::clamp(share, 0.0, 1.0)));
  }
  picture.png = gray_png(picture.width, picture.height, levels);
  return picture;
}

}  // namespace agrisee::io
