// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Joint limits, the turns of a joint within them, and what a move between two postures costs.
///
/// Angles in rad, speeds in rad/s, times in s. A joint that turns more than once reaches the same posture at several
/// angles, 2 pi apart; these functions choose among them.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>
#include <optional>

namespace agrisee::arm {

/// Position and speed limits of six joints.
struct JointLimits {
  Joints min = (Joints() << -kTwoPi, -kTwoPi, -kPi, -kTwoPi, -kTwoPi, -kTwoPi).finished();  ///< rad
  Joints max = (Joints() << kTwoPi, kTwoPi, kPi, kTwoPi, kTwoPi, kTwoPi).finished();        ///< rad
  Joints velocity = (Joints() << kPi, kPi, kPi, kTwoPi, kTwoPi, kTwoPi).finished();         ///< rad/s

  /// The UR3's (its published description): 360 degrees either way, the elbow 180 since farther it meets the upper arm;
  /// 180 deg/s, the wrists 360. Wrist 3 turns without end; 360 degrees either way spares the sensor's cable.
  static JointLimits ur3() { return {}; }

  /// @throws ParameterError naming the field that is out of range
  void check() const {
    for (int j = 0; j < 6; ++j) {
      check_parameter(min[j] <= max[j], "limits.min", "at most limits.max", min[j]);
      check_parameter(velocity[j] > 0.0, "limits.velocity", "positive", velocity[j]);
    }
  }

  /// True when every joint is within its limits, borders included.
  bool contain(const Joints& q) const { return (q.array() >= min.array()).all() && (q.array() <= max.array()).all(); }
};

/// The same direction in (-pi, pi] (rad).
inline double wrap(double angle) {
  if (angle > -kPi && angle <= kPi) return angle;
  const double a = std::remainder(angle, kTwoPi);
  return a <= -kPi ? kPi : a;
}

/// The angle equal to `q` modulo 2 pi that lies in [min, max], nearest to `reference`; nothing when there is none.
/// Where two are exactly as near, half a turn either side of the reference, it is the one farther from q itself.
inline std::optional<double> nearest(double q, double reference, double min, double max) {
  double a = q + kTwoPi * std::round((reference - q) / kTwoPi);
  if (a > max)
    a = q + kTwoPi * std::floor((max - q) / kTwoPi);
  else if (a < min)
    a = q + kTwoPi * std::ceil((min - q) / kTwoPi);
  if (!(a >= min && a <= max)) return std::nullopt;
  return a;
}

/// The angles of the same posture (each joint turned by a multiple of 2 pi) that lie within the limits, each nearest to
/// those of `reference`; nothing when a joint has none.
inline std::optional<Joints> nearest(const Joints& q, const Joints& reference, const JointLimits& limits) {
  Joints out;
  for (int j = 0; j < 6; ++j) {
    const auto a = nearest(q[j], reference[j], limits.min[j], limits.max[j]);
    if (!a) return std::nullopt;
    out[j] = *a;
  }
  return out;
}

/// Euclidean distance (rad) in joint space.
inline double joint_distance(const Joints& from, const Joints& to) { return (to - from).norm(); }

/// Shortest time (s) of a straight move in joint space: the slowest joint turns at its speed limit all the way. A lower
/// bound, since the UR3's acceleration limits are not published.
inline double move_time(const Joints& from, const Joints& to, const JointLimits& limits = {}) {
  return ((to - from).cwiseAbs().cwiseQuotient(limits.velocity)).maxCoeff();
}

}  // namespace agrisee::arm
