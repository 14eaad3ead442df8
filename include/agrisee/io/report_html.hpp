// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The report of a scan as one page for a browser: `report.html` of the result folder.
#pragma once

#include <agrisee/io/results.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace agrisee::io {

/// What a report shows besides the result: things that only whoever drove the scan can know. All of it may be empty.
struct ScanHistory {
  /// A share of the fruit's surface over the views.
  struct Curve {
    std::string name;            ///< as it is shown
    std::vector<double> values;  ///< 0..1, one a view; what is not finite is left out of the curve
  };
  std::vector<Curve> curves;              ///< in the order of the legend
  std::vector<Eigen::Vector3f> frontier;  ///< points where a planner would have looked on (m, world)
};

/// The report as HTML: a page of its own that loads nothing, from a disk or from a network. It shows the cloud by
/// fruit, what was left over, the merged cloud, the frontier, fitted bodies, pose frames, sensors, path and arm view by
/// view, a table of fruit, curves over the views, times and parameters.
///
/// Any result can be reported, also an empty one. Coordinates are stored in 16 bits an axis (an extent of 10 m in steps
/// of 0.15 mm; larger clouds as single precision). Points that are not finite are left out; of more than `max_points`
/// in a cloud every k-th is shown, and the page says so. Links are drawn for views whose UR3 joints are known. Equal
/// arguments give equal bytes. About 0.6 MB and 18 bytes a point of the consolidated, 11 of the merged cloud.
/// @throws InputError for a result that write_result would refuse  @throws ParameterError when `max_points` is 0
std::string report_html(const ScanResult& result, const Workcell& workcell, const RunInfo& info,
                        const ScanHistory& history = {}, std::size_t max_points = 150000);

/// Write that page, atomically. @throws as report_html, and FileError when it cannot be written
void write_report_html(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell,
                       const RunInfo& info, const ScanHistory& history = {});

}  // namespace agrisee::io
