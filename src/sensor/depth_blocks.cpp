// SPDX-License-Identifier: BSD-3-Clause
#include "depth_blocks.hpp"

#include <agrisee/core/median.hpp>
#include <agrisee/core/parallel.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::sensor::detail {
namespace {

/// Pixels up to this far (m) outside of the volume can be of use.
constexpr double kWidestMargin = 0.04;

/// Intrinsics of an image whose pixels are blocks of b x b pixels.
Intrinsics block_intrinsics(const Intrinsics& k, int b) {
  Intrinsics cells;
  cells.width = (k.width + b - 1) / b;
  cells.height = (k.height + b - 1) / b;
  cells.fx = k.fx / b;
  cells.fy = k.fy / b;
  cells.cx = (k.cx + 0.5) / b - 0.5;
  cells.cy = (k.cy + 0.5) / b - 0.5;
  return cells;
}

/// Make block c.
/// @param agree pixels agree with the median when they differ by at most this (m)
/// @param any_depth receives the median depth (m) of all valid pixels
/// @return share of valid pixels
float make_block(const DepthFrame& frame, const std::vector<float>& inside, int cells_across, int b, float agree,
                 std::size_t c, Block& block, float& any_depth) {
  const Intrinsics& k = frame.intrinsics;
  const std::size_t width = static_cast<std::size_t>(k.width);
  const int u0 = static_cast<int>(c % static_cast<std::size_t>(cells_across)) * b;
  const int v0 = static_cast<int>(c / static_cast<std::size_t>(cells_across)) * b;
  float in[64 * 64], any[64 * 64];
  int n_in = 0, n_any = 0;
  const int u1 = std::min(u0 + b, k.width), v1 = std::min(v0 + b, k.height);
  for (int v = v0; v < v1; ++v)
    for (int u = u0; u < u1; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
      if (inside[i] > 0.0f) in[n_in++] = inside[i];
      if (DepthFrame::valid(frame.depth[i])) any[n_any++] = frame.depth[i];
    }
  if (n_any == 0) return 0.0f;
  const float fill = static_cast<float>(n_any) / static_cast<float>((u1 - u0) * (v1 - v0));
  std::nth_element(any, any + n_any / 2, any + n_any);
  any_depth = any[n_any / 2];
  if (n_in == 0) return fill;
  float middle = any_depth;
  if (n_in < n_any) {
    std::nth_element(in, in + n_in / 2, in + n_in);
    middle = in[n_in / 2];
  }
  double su = 0.0, sv = 0.0, sz = 0.0, s1 = 0.0;
  for (int v = v0; v < v1; ++v)
    for (int u = u0; u < u1; ++u) {
      const float z = inside[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)];
      if (z > 0.0f && std::abs(z - middle) <= agree) su += u, sv += v, sz += double(z), s1 += 1.0;
    }
  block.u = static_cast<float>((su / s1 + 0.5) / b - 0.5);
  block.v = static_cast<float>((sv / s1 + 0.5) / b - 0.5);
  block.z = static_cast<float>(sz / s1);
  return fill;
}

}  // namespace

double image_noise(const std::vector<float>& z, int width, int height, int lag) {
  std::vector<float> d;
  for (int v = 0; v < height; ++v)
    for (int u = lag; u + lag < width; ++u) {
      const float* c = &z[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)];
      if (c[-lag] > 0.0f && c[0] > 0.0f && c[lag] > 0.0f) d.push_back(std::abs(c[-lag] - 2.0f * c[0] + c[lag]));
    }
  return 1.4826 * static_cast<double>(median(d)) / std::sqrt(6.0);
}

Crop crop(const DepthFrame& frame, const Pose& world_T_optical, const Aabb& volume) {
  const Intrinsics& k = frame.intrinsics;
  const std::size_t width = static_cast<std::size_t>(k.width);
  const Eigen::Matrix3d rotation = world_T_optical.linear();
  const Eigen::Vector3d origin = world_T_optical.translation();
  Aabb wide = volume;
  wide.min.array() -= kWidestMargin;
  wide.max.array() += kWidestMargin;
  Crop out;
  out.depth.assign(k.size(), 0.0f);
  std::vector<float> depths;
  depths.reserve(k.size() / 4);
  for (int v = 0; v < k.height; ++v) {
    const float* row = &frame.depth[static_cast<std::size_t>(v) * width];
    // The ray of column u at z = 1, in world, is left + u * pitch.
    const Eigen::Vector3d left = rotation * k.ray(0.0, v), pitch = rotation.col(0) / k.fx;
    for (int u = 0; u < k.width; ++u) {
      const float z = row[u];
      if (!DepthFrame::valid(z)) continue;
      const Eigen::Vector3d p = origin + (left + double(u) * pitch) * double(z);
      if (!wide.contains(p)) continue;
      const std::size_t i = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
      const double outside = volume.distance(p);
      if (outside > 0.0) {
        out.near.push_back(i);
        out.near_distances.push_back(static_cast<float>(outside));
        continue;
      }
      out.depth[i] = z;
      depths.push_back(z);
    }
  }
  out.pixels = depths.size();
  if (out.pixels) out.typical = static_cast<double>(median(depths));
  return out;
}

void add_border(const DepthFrame& frame, double noise, Crop& inside) {
  const auto margin = static_cast<float>(4.0 * noise);
  for (std::size_t n = 0; n < inside.near.size(); ++n)
    if (inside.near_distances[n] <= margin) inside.depth[inside.near[n]] = frame.depth[inside.near[n]];
}

Blocks make_blocks(const DepthFrame& frame, const std::vector<float>& inside, int b, double spacing, double pixel_noise,
                   int threads) {
  const Intrinsics& k = frame.intrinsics;
  Blocks out;
  out.cells = block_intrinsics(k, b);
  const std::size_t n = out.cells.size();
  out.depth.assign(n, 0.0f);
  out.blocks.resize(n);
  const float agree = static_cast<float>(std::max(3.0 * pixel_noise, 0.6 * spacing));
  std::vector<float> fill(n, 0.0f);
  const auto make = [&](std::size_t c) {
    fill[c] = make_block(frame, inside, out.cells.width, b, agree, c, out.blocks[c], out.depth[c]);
  };
  parallel_for(n, threads, make, 1024);
  for (std::size_t c = 0; c < n; ++c)
    if (out.blocks[c].z > 0.0f) out.filled.push_back(c);
  std::vector<float> some;
  for (const float share : fill)
    if (share > 0.0f) some.push_back(share);
  out.fill = static_cast<double>(median(some));
  return out;
}

double noise_of(const Blocks& blocks) {
  std::vector<float> z(blocks.blocks.size());
  for (std::size_t c = 0; c < z.size(); ++c) z[c] = blocks.blocks[c].z;
  return image_noise(z, blocks.cells.width, blocks.cells.height, 1);
}

}  // namespace agrisee::sensor::detail
