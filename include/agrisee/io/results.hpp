// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes and reads the result folder of a scan: views.csv, cloud_raw.ply, cloud.ply, fruits.json, fruits.csv and
/// run.json (docs/formats.md describes them). World frame, metres, radians, seconds; quaternions are x y z w. Numbers
/// are printed so that they read back exactly. Files are written atomically: each is complete or absent.
#pragma once

#include <agrisee/result.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace agrisee::io {

constexpr const char* kPicture = "truss.png";   ///< of a result: for people, see render.hpp
constexpr const char* kReport = "report.html";  ///< of a result: for people, see scan_page.hpp
/// All files of a result, those that it can lack included.
constexpr const char* kResultFiles[] = {"run.json",    "views.csv",  "cloud.ply", "cloud_raw.ply",
                                        "fruits.json", "fruits.csv", kPicture,    kReport};

/// How a scan was made; part of run.json.
struct RunInfo {
  std::string scene;               ///< name of the scene, or file of a ready cloud
  std::string version;             ///< version of AgriSEE
  std::string time;                ///< when the result was made, see utc_now; empty: not written
  std::string frame_id = "world";  ///< name of the frame of the result
  std::uint64_t seed = 0;          ///< seed of all random numbers
  int threads = 1;                 ///< number of threads; the result does not depend on it
  std::string noise = "none";      ///< noise model of the simulated sensor
  std::string preset = "default";  ///< see Parameters::preset
  std::string planner;             ///< see Parameters::planner
  std::string parameters_json;     ///< all parameters as a JSON object; empty means {}
  std::string detector;            ///< the simulated detector; empty: none
};

/// The time now, in UTC, as ISO 8601 writes it: "2026-03-21T13:07:55Z". Where the environment variable
/// SOURCE_DATE_EPOCH holds a number of seconds since 1970, it is that time, so that files can be made again byte for
/// byte (reproducible-builds.org).
std::string utc_now();

/// The contents of run.json.
struct RunFile {
  RunInfo info;              ///< how the scan was made
  std::size_t views = 0;     ///< number of views taken
  std::string stop_reason;   ///< see StopReason
  std::size_t merged = 0;    ///< points of the merged cloud
  std::size_t filtered = 0;  ///< points of the consolidated cloud
  std::size_t labelled = 0;  ///< points of the consolidated cloud that belong to a fruit
  Timing seconds;            ///< computing time per stage
};

/// Write views.csv: one row per view, numbered from 0 as in the clouds. Call it after every view, so that a scan that
/// fails leaves the views that it took.
/// @throws InputError for a view that is not finite  @throws FileError when it cannot be written
void write_views(const std::filesystem::path& path, const std::vector<View>& views);

/// Write fruits.json: a list with an object per fruit (docs/formats.md).
///
/// - Always: `id`, `points`, `found_by`, `position_world` and `position_cluster` (see Fruit::position),
///   `centroid_world`, `centroid_cluster`, `sigma_world`, `orientation_world`.
/// - With a fitted body: `center_world` (m), `radii` (m), `body_orientation_world`, `center_covariance_world` (m2,
///   three rows), `rms` (m), `completeness`, `confidence`, `volume` and `volume_error` (m3), `mass` and `mass_error`
///   (kg); the errors are standard errors.
/// - With a picking plan: `picking_order` (from 1), `picking_after` (ids of the fruit that are in the way and must be
///   picked first), `reachable` and `picking_reason` (see PickingReason); unless the reason is `no_body`, also
///   `approach_direction_world` (unit vector from the pre-grasp position to the center of the fruit),
///   `pre_grasp_position_world` (m), `pre_grasp_orientation_world` (of the tool, z along the approach direction),
///   `approach_crossed` (m2, see Picking::crossed) and, if the arm is known, `pre_grasp_joints` (rad).
/// - Where they are known: `truss` (see FoundTruss) and `ripeness` (see Ripeness).
/// @throws InputError for a fruit that is not finite or two with the same id
/// @throws FileError when it cannot be written
void write_fruits(const std::filesystem::path& path, const std::vector<Fruit>& fruits);

/// The text that write_fruits writes. @throws InputError as write_fruits does
std::string fruits_to_json(const std::vector<Fruit>& fruits);

/// Write fruits.csv: the values of fruits.json as a table with a row per fruit. Missing values, such as those of a body
/// or picking plan that does not exist, are empty. Only the upper triangle of the covariance is written; the ids in
/// `picking_after` are separated by spaces.
/// @throws InputError for two fruits with the same id  @throws FileError when it cannot be written
void write_fruits_csv(const std::filesystem::path& path, const std::vector<Fruit>& fruits);

/// Write run.json: how the scan was made, why it stopped, and how many views and points it has (docs/formats.md).
/// `views_discarded` counts the views that were discarded for any reason, `discarded_views` has the reason of each.
/// `completeness` holds the planner's estimates of the shares of the fruit's surface that have been seen (`seen`) and
/// that the arm can observe at all (`observable`). `cluster_origin_world` is the origin of the cluster frame {R}.
/// @throws InputError when `parameters_json` is not JSON  @throws FileError when it cannot be written
void write_run(const std::filesystem::path& path, const ScanResult& result, const RunInfo& info);

/// Write all files of a result into `folder`, which is created if necessary. run.json is written last, so a folder with
/// run.json holds a complete result.
/// @throws InputError for a result that is not finite, whose labels are not one per point, or of which two fruits have
///   the same id; then nothing is written
/// @throws FileError when a file cannot be written
void write_result(const std::filesystem::path& folder, const ScanResult& result, const RunInfo& info);

/// Read views.csv. Columns may be in any order; unknown columns are skipped. Only `view`, `x`, `y` and `z` are
/// required: if the others are missing, rotations are the identity, and the rest is zero or absent.
/// @throws FileError for a missing column, for a group with some columns missing (such as `qx` without `qw`), or a cell
///   that is not a number
std::vector<View> read_views(const std::filesystem::path& path);

/// Read fruits.json. Unknown keys are skipped. A fruit has a body if it has the keys `center_world` and `radii`, and a
/// picking plan if it has `picking_order`.
/// @throws FileError for a missing key, a value of the wrong type, or two fruits with one id
std::vector<Fruit> read_fruits(const std::filesystem::path& path);

/// Read run.json. Unknown keys are skipped.
/// @throws FileError for a missing key, a value of the wrong type, or another format version
RunFile read_run(const std::filesystem::path& path);

}  // namespace agrisee::io
