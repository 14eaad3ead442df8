// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a picture of a scan shows, and from which direction. World frame, metres.
#pragma once

#include <agrisee/result.hpp>
#include <agrisee/workcell.hpp>

#include <vector>

namespace agrisee::io {

/// The direction of a picture, and what must be in sight.
struct Framing {
  std::vector<Eigen::Vector3d> subjects;               ///< points that must be in sight
  Eigen::Vector3d forward = Eigen::Vector3d::UnitY();  ///< viewing direction (unit)
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();       ///< direction that is up in the picture (unit)
};

/// How to look at a result: horizontally from the robot to the middle of the scan volume; without a scan volume,
/// against the mean normal of the cloud. The subjects are the corners of a box around the fruit (or around the cloud,
/// if there is no scan volume or no label), and points on the spheres around the fitted bodies.
Framing frame(const ScanResult& result, const Workcell& workcell);

/// The eight corners of a box.
std::vector<Eigen::Vector3d> corners(const Aabb& box);

/// Radius (m) of the discs that draw the points of a cloud without gaps: 1.15 times the median distance from a point to
/// the sixth of its nearest points (itself included), but at least 0.05 mm and at most 6 mm.
float splat_radius(const Cloud& cloud);

}  // namespace agrisee::io
