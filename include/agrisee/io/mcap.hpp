// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes scans as MCAP files (mcap.dev) for Foxglove, and reads such files and those that ROS 2 records: depth images,
/// camera, poses. docs/recordings.md lists the topics. World frame, metres.
#pragma once

#include <agrisee/io/scan_record.hpp>
#include <agrisee/result.hpp>
#include <agrisee/workcell.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace agrisee::io {

/// Write a scan: one view per second, starting at second 1, then its result. The same scan gives the same bytes.
/// @param cell the workcell of the scan
/// @param view the record of view i, from 0; none after the last one
/// @param result its cloud and fruit
/// @throws FileError when the file cannot be written; InputError for a pose that is not rigid
void write_mcap(const std::filesystem::path& path, const Workcell& cell,
                const std::function<std::optional<ViewRecord>(std::size_t)>& view, const ScanResult& result);

/// Which images of a recording to use, and when the camera stands still.
struct McapChoice {
  std::string topic;         ///< of the depth images; empty: the only one
  std::string world_frame;   ///< frame of the result; empty: `world`, else `base_link`, else the root of the frames
  double least_move = 0.02;  ///< a new view is at least this far from the last one (m) ...
  double least_turn = 0.05;  ///< ... or turned by at least this much (rad)
  double rest = 0.1;         ///< the camera must have stood still for this time before the frame (s)
  double rest_move = 0.001;  ///< largest move during that time (m)
  double rest_turn = 0.004;  ///< largest turn during that time (rad)
};

/// The views of a recording: depth images from where the camera stood still.
class McapRecording {
 public:
  /// Find the views. Reads all poses, but no image.
  /// @throws FileError if it is no such file, or has no depth images, no camera, or no poses of its frame
  explicit McapRecording(const std::filesystem::path& path, const McapChoice& choice = {});

  /// The camera; also base and scan volume, if the file has them (those of write_mcap do).
  const Workcell& workcell() const;
  /// The poses of the views' optical frames (z forward, x right, y down), in the order of time.
  const std::vector<Pose>& world_T_optical() const;
  /// Frames that were left out, and why.
  const std::vector<std::string>& warnings() const;
  /// The depth image of a view, counted from 0. @throws FileError if it is damaged, or its depths cannot be in metres;
  /// InputError if there is no such view
  sensor::DepthFrame frame(std::size_t view) const;

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;  // not changed after the construction, so copies share it
};

}  // namespace agrisee::io
