// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Draws a picture of a scan with a small software renderer.
#pragma once

#include <agrisee/io/png.hpp>
#include <agrisee/result.hpp>
#include <agrisee/workcell.hpp>

namespace agrisee::io {

/// Draw a result from two sides: on the left close up from the front, as the robot sees it; on the right obliquely,
/// with the positions of the sensor.
///
/// The cloud is drawn as shaded surface elements, colored by fruit; points without a normal are discs that face the
/// viewer, and back faces are dimmed. On top of the cloud are drawn the pose frames of the fruit (x red, y green, z
/// blue), their ids and the outlines of the fitted bodies; in the right picture also the scan volume, the frusta of the
/// sensor and its path from the first view (dark) to the last (light). Without a scan volume the picture shows the
/// whole cloud from the side that most normals face. Any result can be drawn, even an empty one; points that are not
/// finite are left out. Lines and texts are antialiased. Cost: O(points + pixels), about 0.1 s.
/// @param result the result to draw
/// @param workcell scan volume, base of the robot, and intrinsics of the sensor
/// @param width pixels, at least 640
/// @param height pixels, at least 360
/// @throws ParameterError for a smaller image  @throws InputError when the labels or normals are not one per point
Image render(const ScanResult& result, const Workcell& workcell, int width = 1600, int height = 900);

/// Draw a result with render() and write the picture as PNG.
/// @throws InputError as render()  @throws FileError when the file cannot be written
void write_picture(const std::filesystem::path& path, const ScanResult& result, const Workcell& workcell);

}  // namespace agrisee::io
