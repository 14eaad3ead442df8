// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Joint limits, the choice among equivalent joint angles, and the duration of a move.
///
/// Angles in rad, speeds in rad/s, times in s. A joint with a range of more than a full turn reaches the same posture
/// at several angles, 2 pi apart; the functions `nearest` choose among them. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>
#include <optional>
#include <string>

namespace agrisee::arm {

/// Position and speed limits of six joints.
struct JointLimits {
  Joints min = (Joints() << -kTwoPi, -kTwoPi, -kPi, -kTwoPi, -kTwoPi, -kTwoPi).finished();  ///< rad
  Joints max = (Joints() << kTwoPi, kTwoPi, kPi, kTwoPi, kTwoPi, kTwoPi).finished();        ///< rad
  Joints velocity = (Joints() << kPi, kPi, kPi, kTwoPi, kTwoPi, kTwoPi).finished();         ///< rad/s

  /// The limits of the UR3, from its published description: +-360 degrees, but +-180 for the elbow, beyond which the
  /// forearm would hit the upper arm; 180 deg/s, and 360 deg/s for the wrists. Wrist 3 could turn without limit, but
  /// +-360 degrees protect the cable of the sensor.
  static JointLimits ur3() { return {}; }

  /// @throws ParameterError with the name of the field that is out of range
  void check() const;

  /// What is wrong with joint angles outside of these limits, with the likely cause; empty if there is nothing wrong.
  /// @param q joint angles (rad)
  /// @param slack how far outside of its limits a joint may be (rad)
  std::string complaint(const Joints& q, double slack = 0.0) const;

  /// True if every joint is within its limits, borders included.
  bool contain(const Joints& q) const;
};

/// The equivalent angle in (-pi, pi] (rad).
inline double wrap(double angle) {
  if (angle > -kPi && angle <= kPi) return angle;
  if (std::abs(angle) < 2.9 * kPi) return angle > 0.0 ? angle - kTwoPi : angle + kTwoPi;  // exact
  const double a = std::remainder(angle, kTwoPi);
  return a <= -kPi ? kPi : a;
}

/// Of the angles equal to `q` modulo 2 pi that lie in [min, max], the one nearest to `reference` (all in rad); nothing
/// if there is none. If two are equally near, half a turn on either side of the reference, it is the one farther from
/// q.
inline std::optional<double> nearest(double q, double reference, double min, double max) {
  double a = q + kTwoPi * std::round((reference - q) / kTwoPi);
  if (a > max)
    a = q + kTwoPi * std::floor((max - q) / kTwoPi);
  else if (a < min)
    a = q + kTwoPi * std::ceil((min - q) / kTwoPi);
  if (!(a >= min && a <= max)) return std::nullopt;
  return a;
}

/// The joint angles of the same posture as `q` (each joint may differ by a multiple of 2 pi) that lie within the limits
/// and nearest to those of `reference`; nothing if some joint has no such angle.
std::optional<Joints> nearest(const Joints& q, const Joints& reference, const JointLimits& limits);

/// Euclidean distance in joint space (rad).
inline double joint_distance(const Joints& from, const Joints& to) { return (to - from).norm(); }

/// Shortest duration (s) of a straight move in joint space, in which the joint that takes longest moves at its speed
/// limit all the way. This is a lower bound: acceleration is ignored, since the UR3's acceleration limits are not
/// published.
double move_time(const Joints& from, const Joints& to, const JointLimits& limits = {});

}  // namespace agrisee::arm
