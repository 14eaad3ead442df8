// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Views of a real camera in `views.yaml`: the camera's intrinsics and, for each view, the file of its depth image, its
/// pose and, optionally, colors and detections (see docs/formats.md). World frame, metres.
#pragma once

#include <agrisee/io/detections.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/sensor/rectify.hpp>
#include <agrisee/workcell.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace agrisee::io {

/// One view of a recording.
struct RecordedView {
  std::filesystem::path depth;              ///< file of the depth image; a relative path: from the folder of views.yaml
  Pose world_T_optical = Pose::Identity();  ///< pose of the camera's optical frame (z forward, x right, y down)
  std::string place;                        ///< "<file>:<line>: views[<i>].depth", for messages
  ChannelFiles channels = {};               ///< colors and masks; relative paths as for `depth`
};

/// The contents of views.yaml.
struct RecordedViews {
  std::filesystem::path folder;       ///< that of views.yaml
  Workcell workcell;                  ///< name, camera and base; an empty scan volume if the file states none
  std::optional<double> depth_scale;  ///< metres per unit of the depth images; none: default_depth_scale
  sensor::Distortion distortion;      ///< of the images; read_frame removes it
  std::vector<RecordedView> views;    ///< in the order in which they were taken
  std::vector<std::string> warnings;  ///< one for each rounded rotation that was made orthonormal
};

/// Read views.yaml. Images are not read yet, but must exist.
/// @throws FileError "<path>:<line>: <key>: ..." for a missing or unknown key, a value out of range, a pose that is not
///   rigid to 1e-3, or an image that does not exist
RecordedViews read_recorded_views(const std::filesystem::path& path);

/// Read the depth image of one view with its other channels, rectified. Points outside the camera's range become no
/// return.
/// @param recorded as read_recorded_views returns it
/// @param view     number of the view, from 0
/// @throws FileError, which names the view, for an image that cannot be read, of another size than the camera's, or
///   whose depths have a median below 0.02 m or above 50 m, since their scale must be wrong; InputError if there is no
///   such view
sensor::DepthFrame read_frame(const RecordedViews& recorded, std::size_t view);

/// The smallest box (m, world) that contains all points of a frame, for use as a scan volume if none is known.
Aabb extent_of(const sensor::DepthFrame& frame, const Pose& world_T_optical);

/// Write views.yaml, atomically; the paths of the depth images are written as they are.
/// @throws InputError for poses that are not rigid or numbers that are not finite; FileError when it cannot be written
void write_recorded_views(const std::filesystem::path& path, const RecordedViews& recorded);

}  // namespace agrisee::io
