// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The records that a running scan writes, so that a scan that was killed can be resumed: `scan.json`, the task of the
/// scan, and `views/0000.view` and so on, the frames as they were taken. To resume, the recorded frames are given to a
/// new Pipeline. Files are written atomically and flushed to the disk.
///
/// A view file contains a line `agrisee view 1` (1 is the version of the format), a line of JSON (`scan`, `view`,
/// `asked`, `reported`, `joints`, `intrinsics`), the depths (m), and the Fingerprint of everything before it (8 bytes).
/// The depths are stored row by row, in runs: the number of pixels with depth 0 to skip and the number of depths that
/// follow (uint32 each), then these depths (float32). All numbers are little-endian.
#pragma once

#include <agrisee/parameters.hpp>
#include <agrisee/sensor/depth_frame.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace agrisee::io {

/// The task of a scan: its scene and everything that its result depends on.
struct ScanTask {
  std::string scene;           ///< absolute path of the scene file
  std::string content;         ///< fingerprint of the scene file and its meshes
  std::string version;         ///< version of AgriSEE
  std::uint64_t seed = 0;      ///< seed of all random numbers
  int threads = 1;             ///< number of threads; the result does not depend on it
  std::string noise = "none";  ///< noise model of the simulated sensor
  std::string planner;         ///< see Parameters::planner, or `greedy`
  bool color = false;          ///< whether the simulated camera returns colors
  std::string detector;        ///< the simulated detector, or empty
  Parameters parameters;       ///< all parameters of the scan

  /// The fingerprint of all members except `scene` and `threads`, which do not change the result. Scans with different
  /// results have different fingerprints.
  std::string fingerprint() const;
};

/// A recorded view.
struct ViewRecord {
  sensor::DepthFrame frame;                       ///< depths as measured
  Pose world_T_optical_asked = Pose::Identity();  ///< pose of the sensor that the planner requested
  Pose world_T_optical = Pose::Identity();        ///< pose that the robot reported
  std::optional<Joints> joints;                   ///< requested joints (rad); none without an arm
};

/// Write scan.json. @throws FileError when it cannot be written
void write_scan_task(const std::filesystem::path& path, const ScanTask& task);

/// Read scan.json. @throws FileError for a missing key, a value of the wrong type, or another format version
ScanTask read_scan_task(const std::filesystem::path& path);

/// The path of the record of a view: `folder`/views/0012.view for view 12.
std::filesystem::path view_record_path(const std::filesystem::path& folder, std::size_t view);

/// Write the record of a view into a result folder.
/// @param folder the result folder  @param view number of the view, from 0  @param record the record to write
/// @param scan fingerprint() of the task
/// @throws InputError for an invalid frame, a pose that is not rigid, or joints that are not finite
/// @throws FileError when it cannot be written
void write_view_record(const std::filesystem::path& folder, std::size_t view, const ViewRecord& record,
                       const std::string& scan);

/// Read the record of a view. @return none if there is no such file
/// @param folder the result folder  @param view number of the view, from 0  @param scan fingerprint() of the task
/// @param pixels number of pixels of the image; a record with another number is rejected before memory is allocated
/// @throws FileError when the record is damaged, has another format version, or belongs to another scan, view or image
///   size
std::optional<ViewRecord> read_view_record(const std::filesystem::path& folder, std::size_t view,
                                           const std::string& scan, std::size_t pixels);

/// Remove scan.json and the records of all views. @throws FileError when they cannot be removed
void remove_scan_records(const std::filesystem::path& folder);

}  // namespace agrisee::io
