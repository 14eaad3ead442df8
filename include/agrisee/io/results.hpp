// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The result folder of a scan: views.csv, cloud_raw.ply, cloud.ply, fruits.json, fruits.csv, run.json (docs: result
/// format). World frame, metres, radians, seconds; quaternions are x y z w. Every number is printed so that it reads
/// back exactly, and every file appears complete or not at all.
#pragma once

#include <agrisee/result.hpp>
#include <agrisee/workcell.hpp>

#include <filesystem>

namespace agrisee::io {

/// How a scan was made.
struct RunInfo {
  std::string scene;               ///< name of the scene, or file of a ready cloud
  std::string version;             ///< of AgriSEE
  std::uint64_t seed = 0;          ///< of everything random
  int threads = 1;                 ///< the result does not depend on it
  std::string noise = "none";      ///< model of the simulated sensor's noise
  std::string preset = "default";  ///< see Parameters::preset
  std::string planner;             ///< see Parameters::planner
  std::string parameters_json;     ///< all parameters as a JSON value; empty = {}
};

/// What run.json says.
struct RunFile {
  RunInfo info;              ///< how it was made
  std::size_t views = 0;     ///< number of views taken
  std::string stop_reason;   ///< see StopReason
  std::size_t merged = 0;    ///< points of the merged cloud
  std::size_t filtered = 0;  ///< points of the consolidated cloud
  std::size_t labelled = 0;  ///< those of them that belong to a fruit
  Timing seconds;            ///< per stage
};

/// Write views.csv; during a scan after every view, so that a scan that fails has left what it took. Row i is view i,
/// counted from 0 as in the clouds.
/// @throws InputError for a view that is not finite  @throws FileError when it cannot be written
void write_views(const std::filesystem::path& path, const std::vector<View>& views);

/// Write fruits.json. Beside the contract's keys, with a body: `center_covariance_world` (m2, three rows), `rms` (m),
/// `volume` and `volume_error` (m3), `mass` and `mass_error` (kg); errors are standard errors. Where the picking was
/// planned: `picking_order` (from 1), `picking_after` (ids of fruit that stand in the way and go before), `reachable`,
/// `picking_reason` (see PickingReason), and, but for `no_body`, `approach_direction_world` (unit, from the pre-grasp
/// position to the fruit's centre), `pre_grasp_position_world` (m) and `pre_grasp_orientation_world` (of the tool, z
/// along the direction), and `pre_grasp_joints` (rad) where the arm's are known.
/// @throws InputError for a fruit that is not finite  @throws FileError when it cannot be written
void write_fruits(const std::filesystem::path& path, const std::vector<Fruit>& fruits);

/// The same as a table; the cells of a body that was not fitted and of what was not planned are empty. Of the
/// covariance the upper triangle is written, the ids of `picking_after` are separated by spaces.
void write_fruits_csv(const std::filesystem::path& path, const std::vector<Fruit>& fruits);

/// Write run.json. Beside the contract's keys `views_discarded` counts the views that were not believed, `completeness`
/// says which share of the fruit's surface the planner believes to have been seen (`seen`) and that the arm can see at
/// all (`observable`), and `cluster_origin_world` says where the cluster frame {R} is, when the workcell has a scan
/// volume.
/// @throws InputError when `parameters_json` is not JSON  @throws FileError when it cannot be written
void write_run(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell,
               const RunInfo& info);

/// Write all files of a result into `folder` (made if need be), run.json last: where it is, the result is complete.
/// @throws InputError for a result that is not finite or whose labels are not one per point; nothing is written then
/// @throws FileError when a file cannot be written
void write_result(const std::filesystem::path& folder, const ScanResult& result, const Workcell& workcell,
                  const RunInfo& info);

/// Read views.csv; columns may stand in any order, further ones are skipped. @throws FileError
std::vector<View> read_views(const std::filesystem::path& path);

/// Read fruits.json; further keys are skipped. A fruit has a body where it has `center_world` and `radii`, a
/// picking where it has `picking_order`.
/// @throws FileError for a missing key, a value of the wrong type, or two fruits with one id
std::vector<Fruit> read_fruits(const std::filesystem::path& path);

/// Read run.json; further keys are skipped. @throws FileError for a missing key, a value of the wrong type, or another
/// format version
RunFile read_run(const std::filesystem::path& path);

}  // namespace agrisee::io
