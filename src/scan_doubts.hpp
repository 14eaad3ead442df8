// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What speaks against the input of a scan: collected view by view, told as sentences with the likely cause.
#pragma once

#include <agrisee/core/rigid_pose.hpp>
#include <agrisee/fuse/calibration_check.hpp>
#include <agrisee/fuse/pose_check.hpp>
#include <agrisee/result.hpp>
#include <agrisee/sensor/depth_frame.hpp>
#include <agrisee/workcell.hpp>

#include <optional>
#include <string>
#include <vector>

namespace agrisee {

/// Collects what speaks against the input of a scan.
class ScanDoubts {
 public:
  /// Look at the next view.
  /// @param reported the pose before it was made rigid
  /// @param camera of the workcell
  void look_at(const sensor::DepthFrame& frame, const Pose& world_T_optical, const Pose& reported,
               const sensor::Intrinsics& camera);

  /// All doubts about the views so far.
  /// @param own_arm whether the model in `workcell` describes the arm
  std::vector<std::string> sentences(const std::vector<View>& views, const Workcell& workcell, bool own_arm) const;

 private:
  /// What speaks against some of the views.
  struct Doubt {
    std::string first;  // what speaks against the first of them
    std::size_t views = 0;
    void add(const std::optional<std::string>& text, std::size_t view);
  };

  Doubt masks_, intrinsics_, other_camera_;
  std::vector<fuse::ViewSample> samples_;  // of the views
  std::size_t rounded_poses_ = 0;          // views whose reported pose had to be made rigid
  double worst_rounding_ = 0.0;            // of these, see rigid_error
};

/// @param view its number
/// @throws InputError for instances of a frame that cannot be masks (sensor::check_masks)
void check_instances(const sensor::DepthFrame& frame, std::size_t view);

/// What speaks against the calibration of the camera: that the views show the fruit in other places, with the change
/// that would make them agree, if one does.
std::optional<std::string> doubt_of(const fuse::CalibrationCheck& check);

/// What speaks against a workcell: the intrinsics of its camera, or a range in which no view is taken.
/// @param distance_min, distance_max from a view to its target (m)
std::vector<std::string> doubts_of(const Workcell& workcell, double distance_min, double distance_max);

/// What speaks against a scan volume: fruit that it cuts through.
std::optional<std::string> doubt_of_volume(const std::vector<Fruit>& fruits, const Aabb& volume);

}  // namespace agrisee
