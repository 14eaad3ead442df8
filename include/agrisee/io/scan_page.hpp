// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The page of a scan: one HTML file for a browser, `report.html` in the result folder.
#pragma once

#include <agrisee/io/depth_picture.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/workcell.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace agrisee::io {

/// What the page shows besides the result. Only the program that ran the scan knows it; all of it may be empty.
struct ScanHistory {
  /// How a share of the fruit's surface grew from view to view.
  struct Curve {
    std::string name;            ///< label of the curve
    std::vector<double> values;  ///< one per view, 0..1; values that are not finite are left out
  };
  std::vector<Curve> curves;              ///< in the order in which the legend lists them
  std::vector<Eigen::Vector3f> frontier;  ///< points at which the planner would have continued (m, world frame)
  /// What the camera saw in each view, by depth_picture(); views beyond the end of the list have no picture.
  std::vector<DepthPicture> depth;
  /// Whether the scan still runs. The page then reloads every few seconds, and so follows a program that writes it
  /// after every view.
  bool running = false;
};

/// The page as HTML text. It is complete in itself: it loads nothing from the disk or the network. It shows the cloud
/// colored by fruit, the points of no fruit, the merged cloud, the frontier, the fitted bodies and pose frames; view
/// by view the sensor, its path, the arm and the depth image; a table of the fruit, curves over the views, times and
/// parameters.
///
/// Every result that write_result accepts can be shown, even an empty one. Coordinates are stored in 16 bits per axis
/// (an extent of 10 m in steps of 0.15 mm); clouds with a larger extent in single precision. Points that are not finite
/// are left out. Of a cloud with more than `max_points` points every k-th is shown, and the page says so. The arm
/// is drawn for views whose joints are known. Equal arguments give equal bytes. Size: about 0.65 MB, 18 bytes
/// per point of the consolidated and 11 per point of the merged cloud, and 4/3 of the depth pictures, of which at most
/// 3 MB are shown: above that, only those of every k-th view.
/// @param result what to show
/// @param workcell scan volume, keep-out solids, robot and sensor
/// @param info how the scan was made
/// @param history curves and frontier of the scan
/// @param max_points largest number of points that is shown of each cloud
/// @throws InputError for a result that write_result rejects  @throws ParameterError when `max_points` is 0
std::string scan_page(const ScanResult& result, const Workcell& workcell, const RunInfo& info,
                      const ScanHistory& history = {}, std::size_t max_points = 150000);

/// Write the page of a scan to a file, atomically.
/// @throws InputError as scan_page  @throws FileError when the file cannot be written
void write_scan_page(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell,
                     const RunInfo& info, const ScanHistory& history = {});

}  // namespace agrisee::io
