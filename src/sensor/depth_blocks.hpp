// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The first two steps of reconstruct_surface: the pixels of the scan volume, and blocks of them. Metres.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/sensor/depth_frame.hpp>

#include <cstddef>
#include <vector>

namespace agrisee::sensor::detail {

/// Robust standard deviation (m) of an image's noise, from second differences of pixels `lag` apart along rows (median
/// of their sizes, scaled to a Gaussian). Differences across invalid pixels are left out.
double image_noise(const std::vector<float>& z, int width, int height, int lag);

/// The pixels inside the volume and near it.
struct Crop {
  std::vector<float> depth;           ///< z (m) of each pixel inside; 0 where it is invalid or outside
  std::vector<std::size_t> near;      ///< pixels outside, but within 4 cm
  std::vector<float> near_distances;  ///< how far outside these are (m)
  std::size_t pixels = 0;             ///< how many are inside
  double typical = 1.0;               ///< their median depth (m)
};

/// Sort the pixels of a frame into those inside the volume, near it and elsewhere.
Crop crop(const DepthFrame& frame, const Pose& world_T_optical, const Aabb& volume);

/// Add the pixels that are outside of the volume only by their noise. Without them the pixels that their noise moved
/// inwards would prevail at the volume's border, and the surface would bend there like that of a fruit.
/// @param noise standard deviation of a pixel's depth (m)
void add_border(const DepthFrame& frame, double noise, Crop& inside);

/// The pixels of a block that agree with its median: their mean pixel (in cells) and depth (m). z = 0: there are none.
struct Block {
  float u = 0.0f, v = 0.0f, z = 0.0f;
};

/// The image as blocks of b x b pixels.
struct Blocks {
  Intrinsics cells;                 ///< of the blocks
  std::vector<Block> blocks;        ///< row by row
  std::vector<std::size_t> filled;  ///< the numbers of those with pixels that agree
  std::vector<float> depth;         ///< median (m) of all valid pixels of a block, inside the volume or not; 0: none
  double fill = 0.0;                ///< median share of valid pixels in blocks with any

  const Block& at(int u, int v) const { return blocks[cells.index(u, v)]; }
};

/// Divide an image into blocks of b x b pixels.
/// @param inside depth (m) of the pixels that count; 0: does not count
/// @param b at most 64
/// @param spacing wanted distance between blocks (m)
/// @param pixel_noise standard deviation of a pixel's depth (m)
Blocks make_blocks(const DepthFrame& frame, const std::vector<float>& inside, int b, double spacing, double pixel_noise,
                   int threads);

/// Robust standard deviation (m) of the noise between blocks.
double noise_of(const Blocks& blocks);

}  // namespace agrisee::sensor::detail
