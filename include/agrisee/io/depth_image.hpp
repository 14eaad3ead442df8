// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads and writes the depth images of a camera: PNG with 16 bits, and NPY (numpy.save).
#pragma once

#include <agrisee/sensor/depth_frame.hpp>

#include <filesystem>
#include <optional>
#include <vector>

namespace agrisee::io {

/// A depth image as its file states it.
struct DepthImage {
  int width = 0;               ///< pixels per row
  int height = 0;              ///< rows
  std::vector<float> values;   ///< row by row from the top left, in the unit of the file
  bool whole_numbers = false;  ///< the file holds integers: a PNG, or an NPY of an integer type
};

/// Metres per unit of an image if it is not stated: 0.001 for whole numbers, 1 for floats.
inline double default_depth_scale(const DepthImage& image) { return image.whole_numbers ? 0.001 : 1.0; }

/// Read a depth image. The first bytes say whether it is PNG (one channel of 16 bits) or NPY (two dimensions, rows by
/// columns; integers or floats).
/// @throws FileError when the file cannot be read, is of another kind, or is damaged
DepthImage read_depth_image(const std::filesystem::path& path);

/// Turn an image into a frame. Pixels that are 0, negative or not finite, and the largest number of 16 bits (65535),
/// which some cameras use, have no return.
/// @param image      as read_depth_image returns it
/// @param intrinsics of the image; the sizes have to agree
/// @param scale      metres per unit
/// @throws InputError when the sizes differ
sensor::DepthFrame to_frame(const DepthImage& image, const sensor::Intrinsics& intrinsics, double scale);

/// Write a frame as PNG with 16 bits, atomically. Depths are rounded to a whole number of units; without a return, and
/// beyond 65534 units, 0 is written.
/// @param path  the file to write
/// @param frame depths (m)
/// @param scale metres per unit
/// @throws InputError for an empty frame, ParameterError for a scale that is not positive, FileError when the file
///   cannot be written
void write_depth_png(const std::filesystem::path& path, const sensor::DepthFrame& frame, double scale = 0.001);

/// Write a frame as NPY with floats (m), atomically. Reading it gives the same depths, bit for bit.
/// @throws InputError for an empty frame, FileError when the file cannot be written
void write_depth_npy(const std::filesystem::path& path, const sensor::DepthFrame& frame);

}  // namespace agrisee::io
