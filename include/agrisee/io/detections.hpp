// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads detections, and adds them and colors to a depth frame (docs/color.md).
#pragma once

#include <agrisee/sensor/depth_frame.hpp>

#include <filesystem>
#include <vector>

namespace agrisee::io {

/// The files that belong to a depth image; an empty path means none.
struct ChannelFiles {
  std::filesystem::path color;  ///< color image
  std::filesystem::path masks;  ///< label image; classes and scores come from a file of the same name with .json or
                                ///< .csv beside it, if there is one
  std::filesystem::path boxes;  ///< boxes with classes and scores, JSON or CSV
};

/// Read detections from a table (CSV with a header line) or a list of objects (JSON).
///
/// Columns or keys: `instance` (or `label`, `id`; boxes without one get, in their order, the lowest that none states),
/// `class` (default: a fruit without a name), `score` (or `confidence`; default 1), and a box as `u v width height` in
/// pixels (or `x y w h`, or `box_u box_v box_w box_h`; in JSON also `box: [u, v, width, height]`). Others are skipped,
/// unless they look like a misspelled `instance`, `class`, `score` or `box` that is missing.
/// The classes leaf, stem, branch, other and background are no fruit, all others are.
/// @param first the lowest instance of boxes that state none
/// @throws FileError, which names the line or key, for a file that cannot be read, an instance outside 1..65535 or
/// listed twice, a score outside 0..1, an empty box, or a misspelled name
std::vector<sensor::Detection> read_detections(const std::filesystem::path& path, std::size_t first = 1);

/// Add the channels of some files to a depth frame. A box is used if its instance has no mask; otherwise both are the
/// same detection. Boxes that name no instance belong to none of the masks.
/// @throws FileError as the readers, for an image of another size than the depth image, for masks that are none
/// (sensor::check_masks), and for boxes that are shares of the image, corners, or wholly outside of the image
void add_channels(sensor::DepthFrame& frame, const ChannelFiles& files);

/// Write the channels of a depth frame so that add_channels reads the same: colors, masks, and detections in a file of
/// the masks' name with .json.
/// @param files a channel without a path is not written; those of boxes are not needed
/// @throws InputError if the frame lacks a channel; FileError when a file cannot be written
void write_channels(const sensor::DepthFrame& frame, const ChannelFiles& files);

}  // namespace agrisee::io
