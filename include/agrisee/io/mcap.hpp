// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Scans as MCAP files (mcap.dev), which Foxglove shows and ROS 2 records: depth images, camera, poses.
/// docs/recordings.md lists the topics. World frame, metres.
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

/// Write a scan: a view a second from second 1 on, then its result. The same scan gives the same bytes.
/// @param cell where it was made
/// @param view the record of view i, from 0; none behind the last one
/// @param result its cloud and fruit
/// @throws FileError when the file cannot be written; InputError for a pose that is not rigid
void write_mcap(const std::filesystem::path& path, const Workcell& cell,
                const std::function<std::optional<ViewRecord>(std::size_t)>& view, const ScanResult& result);

/// What to take from a recording.
struct McapChoice {
  std::string topic;         ///< of the depth images; empty: the only one
  std::string world_frame;   ///< empty: `world`, else `base_link`, else the root of the tree of frames
  double least_move = 0.02;  ///< a frame is a view if the camera has moved by this much since the last one (m) ...
  double least_turn = 0.05;  ///< ... or turned by this much (rad), and stands still
  double rest = 0.1;         ///< how long it has to stand still before the frame (s)
  double rest_move = 0.001;  ///< largest move in that time (m)
  double rest_turn = 0.004;  ///< largest turn in that time (rad)
};

/// The views of a recording: depth images from where the camera stood still.
class McapRecording {
 public:
  /// Find the views. Reads all poses, but no image.
  /// @throws FileError if it is no such file, or has no depth images, no camera, or no poses of its frame
  explicit McapRecording(const std::filesystem::path& path, const McapChoice& choice = {});

  /// Camera; base and scan volume where the file states them (those that write_mcap wrote).
  const Workcell& workcell() const;
  /// The poses of the views' optical frames (z forward, x right, y down), in the order of time.
  const std::vector<Pose>& world_T_optical() const;
  /// What to know: frames that were left out, and why.
  const std::vector<std::string>& warnings() const;
  /// The depth image of a view. @throws FileError if it is damaged, or its depths cannot be in metres
  sensor::DepthFrame frame(std::size_t view) const;

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;  // not changed after the construction, so copies share it
};

}  // namespace agrisee::io
