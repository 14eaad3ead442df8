// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tests after a scan whether the camera is calibrated and the plant stood still: do the views show the surface of a
/// fruit in the same place?
///
/// If they do so only after the same change of every view, such as depths 5 % larger or a camera 30 mm further ahead on
/// the flange, then this is the mistake. Points of different views that are near each other and face the same way are
/// taken for the same surface, and the change is the least-squares solution for their distances along the normals, as
/// in point-to-plane ICP (Chen & Medioni, Image and Vision Computing 1992), with matches found again after every step.
/// What it makes of a body is told by the ball whose surface is nearest to its points after the change: by how far its
/// center is from the body's, and by the ratio of its volume to that of the ball which is nearest to the body's surface
/// in the same directions. If they do so only after all views from one on are shifted alike, the plant has moved, or
/// the arm has slipped. Only fruit count: cameras that look into leaves measure them too deep, from every side. World
/// frame, metres. Cost: some 10 ms; if the views disagree, some 0.2 s. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/fuse/body_errors.hpp>

#include <string>
#include <vector>

namespace agrisee::fuse {

/// How far a body is off if the calibration is as wrong as it seems. If several changes are as good, one is as likely
/// as another.
struct Misplacement {
  Eigen::Matrix3d shift = Eigen::Matrix3d::Zero();  ///< mean of shift * shift', its center's (m2)
  double volume = 0.0;                              ///< root mean square of the change of its volume, relative to it
};

/// How well the views of a scan agree on the fruit with the calibration as it is, and with another.
struct CalibrationCheck {
  /// Median distance along the normals of what two views show (m); 0 = nothing to compare. If only a motion of the
  /// plant is told: of what a view before and one after it show.
  double apart = 0.0;
  double mended = 0.0;  ///< the same after the best change (m)
  /// The change in words, if the views agree so much better that it must be right. If several are as good, all of them:
  /// views from one distance cannot tell a wrong scale from a camera further ahead.
  std::string mistake;
  /// How far the plant moved between two views (m), if that is among the mistakes; else zero.
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  /// What the changes of the calibration among the mistakes do to each body; empty if there is none among them.
  std::vector<Misplacement> misplaced;
};

/// Test whether a wrong scale of the depths, distances along the rays in place of depths z, wrong focal lengths, a
/// wrong hand-eye transform or a plant that moved once explain that the views disagree.
/// @param views of a scan, with some of their points and normals
/// @param bodies of the fruit; what is farther from each than half of its radius does not count
/// @throws Cancelled
CalibrationCheck check_calibration(const std::vector<RegisteredView>& views, const std::vector<Ellipsoid>& bodies);

}  // namespace agrisee::fuse
