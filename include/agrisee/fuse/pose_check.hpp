// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A cheap test of the poses of recorded views before they are fused: do the views show the same surfaces in the same
/// places? If they do so only after all poses are changed in the same way, such as inverted, that is the mistake. World
/// frame, metres. Cost: some 0.1 s. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/sensor/depth_frame.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee::fuse {

/// What poses have to be, for messages.
inline constexpr const char* kRuleOfPoses =
    "Poses have to be world_T_optical: z forward, x right, y down; quaternions are x y z w";

/// Some points of a view.
struct ViewSample {
  std::vector<Eigen::Vector3f> points;      ///< m, optical frame
  Pose world_T_optical = Pose::Identity();  ///< as reported
};

/// Some 5000 points of a frame, evenly spread over its image.
ViewSample sample_of(const sensor::DepthFrame& frame, const Pose& world_T_optical);

/// Share (0..1) of the points of a view that have points of another view within one or two cells; the mean over the
/// views. 0 for fewer than two views with points.
/// @param views at most 16 of them are used, evenly picked
/// @param cell edge length of the cells in which points are compared (m), > 0
double agreement(const std::vector<ViewSample>& views, double cell);

/// How well the views agree with the reported poses, and with all poses changed.
struct PoseCheck {
  double as_reported = 0.0;  ///< agreement with the reported poses
  double mended = 0.0;       ///< agreement after the best change
  std::string mistake;       ///< the mistake in words, if that change is so much better that it must be right
};

/// Test whether poses are inverted, belong to a frame with other axes than the optical one (x forward, or y up), or
/// come from quaternions whose w was taken for x.
///
/// A change is accepted as the correction if at least 40 % of the points agree with it, and twice as many as without
/// it. A single view, which has no other to agree with, is assumed to see the scan volume.
/// @param views of a recording
/// @param volume the scan volume (world); empty if unknown
PoseCheck check_poses(const std::vector<ViewSample>& views, const Aabb& volume);

}  // namespace agrisee::fuse
