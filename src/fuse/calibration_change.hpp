// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Changes of a camera's calibration, and what they make of the views of a scan. Metres, radians.
#pragma once

#include <agrisee/core/cloud.hpp>
#include <agrisee/fuse/calibration_check.hpp>

#include <cstddef>
#include <limits>
#include <vector>

namespace agrisee::fuse {

/// A change that may make the views agree: of the calibration, or of where later views are.
struct CalibrationChange {
  static constexpr Eigen::Index kUnknowns = 11;
  using Vector = Eigen::Matrix<double, kUnknowns, 1>;
  /// Depth scale - 1, 1 / focal scale - 1, shift (m) and turn (rad) of the camera, motion of the plant (m, world).
  Vector unknowns = Vector::Zero();
  bool along_rays = false;  ///< depths are distances along the rays
  /// The plant moved before this sample.
  std::size_t moved_before = std::numeric_limits<std::size_t>::max();

  double depth() const { return unknowns[0]; }
  double spread() const { return unknowns[1]; }
  Eigen::Vector3d shift() const { return unknowns.segment<3>(2); }
  Eigen::Vector3d turn() const { return unknowns.segment<3>(5); }
  Eigen::Vector3d motion() const { return unknowns.tail<3>(); }
  Eigen::Matrix3d rotation() const {
    return Eigen::AngleAxisd(turn().norm(), turn().stableNormalized()).toRotationMatrix();
  }
};

/// What a view shows of the fruit, in its optical frame.
struct FruitSample {
  std::size_t view = 0;  ///< its number
  Pose world_T_optical = Pose::Identity();
  std::vector<Eigen::Vector3d> points, normals;
  std::vector<std::size_t> bodies;  ///< of each point, by number
};

/// Points of a view after a change: in the changed optical frame, and in the world.
struct PlacedSample {
  Eigen::Matrix3d rotation;  ///< of the optical frame in the world
  std::vector<Eigen::Vector3d> points, normals;
  PointCloud<float> in_world;  ///< with normals
  bool moved = false;          ///< whether the plant had moved by then
};

/// What a view shows after a change.
/// @param moved whether the plant had moved by then
PlacedSample placed(const FruitSample& sample, const CalibrationChange& change, bool moved);

/// What changes of the calibration, as likely one as another, make of bodies, which were fitted to registered views.
/// One of which too little was compared is as far off as the others on average.
std::vector<Misplacement> misplaced(const std::vector<FruitSample>& samples,
                                    const std::vector<CalibrationChange>& changes, const std::vector<Ellipsoid>& bodies,
                                    const std::vector<RegisteredView>& views);

}  // namespace agrisee::fuse
