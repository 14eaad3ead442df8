// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A picture of a scan, drawn by a small software renderer.
#pragma once

#include <agrisee/io/png.hpp>
#include <agrisee/result.hpp>
#include <agrisee/workcell.hpp>

namespace agrisee::io {

/// Draw a result from two sides: close up from the front as the robot sees it, and obliquely with the sensor's
/// positions.
///
/// The cloud is drawn as shaded surface elements coloured by fruit (points without a normal as discs that face the
/// eye), seen back faces dimmed; on top of it the pose frames (x red, y green, z blue) with the fruit's numbers,
/// outlines of the fitted bodies, and on the right the scan volume, the sensor's frusta and its path from first (dark)
/// to last (light). Without a scan volume the picture frames the cloud, seen from the side that most normals face.
/// Twofold supersampling. Any result can be drawn, also an empty one; points that are not finite are left out. Cost:
/// O(points + pixels), about 0.3 s.
/// @param result what is drawn
/// @param workcell scan volume and frames
/// @param width, height pixels, at least 640 x 360
/// @throws ParameterError for a smaller image  @throws InputError when the labels or normals are not one per point
Image render(const ScanResult& result, const Workcell& workcell, int width = 1600, int height = 900);

/// Write that picture as PNG. @throws FileError when it cannot be written
void write_picture(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell);

}  // namespace agrisee::io
