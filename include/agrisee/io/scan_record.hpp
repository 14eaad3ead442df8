// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a scan writes while it goes on, so that it can be taken up again after it was killed: `scan.json`, what was
/// asked for, and `views/0000.view` and so on, each frame as it was taken. The state of a scan is rebuilt by giving the
/// recorded frames to a Pipeline anew. Every file appears complete and on the disk, or not at all.
///
/// A view's file: a line `agrisee view 1` (the format's version), a line of JSON (`scan`, `view`, `asked`, `reported`,
/// `joints`, `intrinsics`), the depths (m) row by row, and the Fingerprint of all before, 8 bytes. The depths are runs:
/// how many pixels of 0 are skipped, how many follow (uint32 each), those that follow (float32); little-endian.
#pragma once

#include <agrisee/parameters.hpp>
#include <agrisee/sensor/depth_frame.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace agrisee::io {

/// What a scan was asked to do, and of what.
struct ScanTask {
  std::string scene;           ///< scene file, as an absolute path
  std::string content;         ///< fingerprint of the scene file and its meshes
  std::string version;         ///< of AgriSEE
  std::uint64_t seed = 0;      ///< of everything random
  int threads = 1;             ///< the result does not depend on it
  std::string noise = "none";  ///< model of the simulated sensor's noise
  std::string planner;         ///< see Parameters::planner, or greedy
  Parameters parameters;       ///< all of them

  /// Unlike that of any other scan: all of the above but `scene` and `threads`, which change nothing of the result.
  std::string fingerprint() const;
};

/// A view as it was taken.
struct ViewRecord {
  sensor::DepthFrame frame;                       ///< as measured
  Pose world_T_optical_asked = Pose::Identity();  ///< where the planner wanted the sensor
  Pose world_T_optical = Pose::Identity();        ///< where the robot says that it was
  std::optional<Joints> joints;                   ///< asked for; absent without an arm
};

/// Write scan.json. @throws FileError when it cannot be written
void write_scan_task(const std::filesystem::path& path, const ScanTask& task);

/// Read scan.json. @throws FileError for a missing key, a value of the wrong type, or another format version
ScanTask read_scan_task(const std::filesystem::path& path);

/// `folder`/views/0012.view
std::filesystem::path view_record_path(const std::filesystem::path& folder, std::size_t view);

/// Write the record of a view into a result folder.
/// @param folder of the result  @param view its number, from 0  @param record what to write
/// @param scan the task's fingerprint()
/// @throws InputError for a frame, pose or joints that are not usable  @throws FileError when it cannot be written
void write_view_record(const std::filesystem::path& folder, std::size_t view, const ViewRecord& record,
                       const std::string& scan);

/// Read the record of a view; nothing where there is none.
/// @param folder of the result  @param view its number, from 0  @param scan the task's fingerprint()
/// @param pixels of the image; no larger one is made room for, whatever the record says
/// @throws FileError when it is damaged, of another scan, view or image size, or of another format version
std::optional<ViewRecord> read_view_record(const std::filesystem::path& folder, std::size_t view,
                                           const std::string& scan, std::size_t pixels);

/// Remove scan.json and the records of all views. @throws FileError when they cannot be removed
void remove_scan_records(const std::filesystem::path& folder);

}  // namespace agrisee::io
