// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A cheap test of the poses of recorded views, before anything is fused: do the views show the same surfaces in the
/// same places? If they do so only when every pose is changed in the same way, such as inverted, then that is the
/// mistake. World frame, metres. Cost: some 0.1 s. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/sensor/depth_frame.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee::fuse {

/// Some points of a view.
struct ViewSample {
  std::vector<Eigen::Vector3f> points;      ///< m, optical frame
  Pose world_T_optical = Pose::Identity();  ///< as reported
};

/// Some 5000 points of a frame, evenly spread over its image.
ViewSample sample_of(const sensor::DepthFrame& frame, const Pose& world_T_optical);

/// Share (0..1) of the points of a view near which another view has points, too, within one or two cells; the mean over
/// the views. 0 for fewer than two views with points.
/// @param views at most 16 of them are used, evenly picked
/// @param cell edge length of the cells in which points are compared (m), > 0
double agreement(const std::vector<ViewSample>& views, double cell);

/// How well the views agree with their poses as reported, and how after a change of all poses.
struct PoseCheck {
  double as_reported = 0.0;  ///< agreement with the reported poses
  double mended = 0.0;       ///< agreement after the change that suits the views best
  std::string mistake;       ///< what the poses are, in words, if that change is so much better that it must be right
};

/// Test whether poses are inverted, or belong to a frame of other axes than the optical one (x forward, or y up).
///
/// A change is believed to mend the mistake if at least 40 % of the points agree with it, and twice as many as without
/// it. A single view, which agrees with nothing, is believed to see the scan volume.
/// @param views of a recording
/// @param volume the scan volume (world); empty if it is not known
PoseCheck check_poses(const std::vector<ViewSample>& views, const Aabb& volume);

}  // namespace agrisee::fuse
