// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Faults of sensor and arm that a simulation can add (faults.hpp): their kinds, how often they occur, and the record
/// of a scan with faults. Metres, radians.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/core/types.hpp>

#include <cstddef>
#include <optional>
#include <string>

namespace agrisee::study {

/// What can go wrong with a view.
enum class Fault {
  empty_frame,       ///< no pixel returns
  nan_frame,         ///< every pixel is NaN
  frozen_frame,      ///< the sensor returns its last frame again
  dropped_frame,     ///< the arm arrives, but the sensor returns no frame
  wrong_intrinsics,  ///< the frame's focal lengths are 1 % too long
  noisy_pose,        ///< the reported pose is off by 0.5 mm and 0.1 degree (standard deviations, each axis)
  wrong_pose,        ///< the reported pose is off by 50 mm
  refused_motion,    ///< the arm does not move
  timeout            ///< the arm does not answer in time, which counts as refused
};
constexpr std::size_t kFaults = 9;  ///< number of kinds

/// The name of a fault, as in reports.
inline const char* to_string(Fault fault) {
  constexpr const char* kNames[kFaults] = {"empty_frame",   "nan_frame",        "frozen_frame",
                                           "dropped_frame", "wrong_intrinsics", "noisy_pose",
                                           "wrong_pose",    "refused_motion",   "timeout"};
  return kNames[static_cast<std::size_t>(fault)];
}

/// Which faults occur, how often, and how large they are.
struct FaultParameters {
  double rate = 0.1;                 ///< share of the requested views that go wrong
  std::optional<Fault> kind;         ///< the only kind that occurs; none: all kinds, each equally likely
  double intrinsics_error = 0.01;    ///< relative error of the focal lengths
  double position_noise = 0.0005;    ///< standard deviation of a noisy pose's position, per axis (m)
  double rotation_noise = deg(0.1);  ///< standard deviation of a noisy pose's rotation, per axis (rad)
  double position_error = 0.05;      ///< position error of a wrong pose, in any direction (m)

  /// @throws FieldError for the first field that is out of its range
  void check() const { check_fields(*this); }

  /// f(name, field, range) for every field; without a range for `kind`.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("rate", p.rate, Range::between(0.0, 1.0));
    f("kind", p.kind);
    f("intrinsics_error", p.intrinsics_error, Range::above(-1.0));
    f("position_noise", p.position_noise, Range::not_negative());
    f("rotation_noise", p.rotation_noise, Range::not_negative());
    f("position_error", p.position_error, Range::not_negative());
  }
};

/// A scan with faults, and what came of it.
struct FaultRecord {
  std::string scene;         ///< name of the scene
  std::string kind = "any";  ///< name of the only kind of fault, or `any`
  double rate = 0.0;         ///< see FaultParameters
  int trial = 1;             ///< seed of the scan
  int fruit = 0;             ///< number of true fruit
  int found = 0;             ///< number of true fruit that were found
  int invented = 0;          ///< number of located fruit that do not exist
  int views = 0;             ///< number of views taken
  int discarded = 0;         ///< how many of them the pipeline discarded
  int faults = 0;            ///< number of faults that occurred
  int wrong_poses = 0;       ///< how many of these were Fault::wrong_pose
  int wrong_believed = 0;    ///< how many views with a wrong pose showed something and were not discarded
  std::string stop_reason;   ///< see StopReason
  double seconds = 0.0;      ///< computing time, without the simulated sensor
};

}  // namespace agrisee::study
