// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Faults of the world: their kinds, how often they strike, and what is recorded of a scan under them. Metres, radians.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/pose.hpp>

#include <optional>
#include <string>

namespace agrisee::study {

/// What can go wrong with a view.
enum class Fault {
  empty_frame,       ///< no pixel returns
  nan_frame,         ///< all pixels are NaN
  frozen_frame,      ///< the last frame again
  dropped_frame,     ///< the arm arrives, no frame does
  wrong_intrinsics,  ///< the frame's focal lengths are 1 % too long
  noisy_pose,        ///< the reported pose is off by 0.5 mm and 0.1 degree (standard deviations, each axis)
  wrong_pose,        ///< the reported pose is off by 50 mm
  refused_motion,    ///< the arm does not move
  timeout            ///< no answer in time: as if refused
};
constexpr std::size_t kFaults = 9;  ///< how many kinds there are

/// Its name.
inline const char* to_string(Fault fault) {
  constexpr const char* kNames[kFaults] = {"empty_frame",   "nan_frame",        "frozen_frame",
                                           "dropped_frame", "wrong_intrinsics", "noisy_pose",
                                           "wrong_pose",    "refused_motion",   "timeout"};
  return kNames[static_cast<std::size_t>(fault)];
}

/// How often what goes wrong.
struct FaultParameters {
  double rate = 0.1;                 ///< share of the views asked for that go wrong
  std::optional<Fault> kind;         ///< of all of them; none = any, each as likely
  double intrinsics_error = 0.01;    ///< of the focal lengths
  double position_noise = 0.0005;    ///< of a noisy pose (m, each axis)
  double rotation_noise = deg(0.1);  ///< of a noisy pose (rad, each axis)
  double position_error = 0.05;      ///< of a wrong pose (m, in any direction)

  /// @throws ParameterError naming the field
  void check() const {
    check_parameter(rate >= 0 && rate <= 1, "rate", "in [0, 1]", rate);
    check_parameter(intrinsics_error > -1, "intrinsics_error", "above -1", intrinsics_error);
    check_parameter(position_noise >= 0, "position_noise", "not negative", position_noise);
    check_parameter(rotation_noise >= 0, "rotation_noise", "not negative", rotation_noise);
    check_parameter(position_error >= 0, "position_error", "not negative", position_error);
  }
};

/// A scan under faults, and what came of it.
struct FaultRecord {
  std::string scene;         ///< its name
  std::string kind = "any";  ///< the fault's name
  double rate = 0.0;         ///< see FaultParameters
  int trial = 1;             ///< the seed
  int fruit = 0;             ///< that there are
  int found = 0;             ///< of them
  int invented = 0;          ///< located without being there
  int views = 0;             ///< taken
  int discarded = 0;         ///< of them
  int faults = 0;            ///< that struck
  int wrong_poses = 0;       ///< of them: the reported pose was 50 mm off
  int wrong_believed = 0;    ///< of these: views that were not discarded, though they showed something
  std::string stop_reason;   ///< see StopReason
  double seconds = 0.0;      ///< of computing
};

}  // namespace agrisee::study
