// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Kinematics of the Universal Robots UR3: forward kinematics, Jacobian, and all inverse solutions in closed form.
///
/// Poses are those of tool0 in base_link (REP-103, x forward). The DH chain of the controller starts in the frame
/// `base`, which is base_link turned by pi about z; here this turn is part of the first joint. Link frames are those of
/// the robot's published description: each joint turns about the z axis of its own frame. Metres and radians.
///
/// The inverse uses that three axes are parallel (shoulder lift, elbow, wrist 1; Hawkins, "Analytic Inverse Kinematics
/// for the Universal Robots UR-5/UR-10 Arms", 2013). Let n be the direction of these axes. The wrist's center lies d4
/// along n, which gives joint 1. The angle between n and the axis of the tool is joint 5. The direction of n in the
/// frame of the tool gives joint 6. The remaining joints form a planar arm with two links. All solutions take about 2
/// us.
#pragma once

#include <agrisee/arm/limits.hpp>
#include <agrisee/core/pose.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace agrisee::arm {

/// Denavit-Hartenberg lengths of the UR3 (m), as published by the manufacturer.
namespace ur3 {
constexpr double d1 = 0.1519;    ///< from the base to the shoulder, along the axis of joint 1
constexpr double a2 = -0.24365;  ///< upper arm
constexpr double a3 = -0.21325;  ///< forearm
constexpr double d4 = 0.11235;   ///< wrist 1, along its joint axis
constexpr double d5 = 0.08535;   ///< wrist 2
constexpr double d6 = 0.0819;    ///< from wrist 3 to tool0
}  // namespace ur3

/// Below this |sin q5| the axes of joints 4 and 6 count as parallel: a wrist singularity.
constexpr double kWristSingularity = 1e-10;

/// Inverse solutions whose joints all agree to within this angle (rad, modulo 2 pi) count as one; at a singularity two
/// branches of the solution coincide.
constexpr double kSameSolution = 1e-6;

/// Poses in base_link of the six link frames: shoulder, upper arm, forearm, wrist 1, wrist 2, wrist 3. Each frame moves
/// with its link and turns about its own z axis. The last one is tool0.
using LinkFrames = std::array<Pose, 6>;

/// The link frames at joint angles `q` (rad).
/// @throws InputError if a joint angle is not finite
inline LinkFrames link_frames(const Joints& q) {
  check_input(q.allFinite(), "UR3: a joint angle is not finite");
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]);
  const Eigen::Vector3d out(-c1, -s1, 0.0),
      n(-s1, c1, 0.0);  // horizontal direction and normal of the arm's vertical plane
  LinkFrames f;
  const auto set = [&](std::size_t i, const Eigen::Vector3d& x, const Eigen::Vector3d& y, const Eigen::Vector3d& z,
                       const Eigen::Vector3d& origin) { f[i].matrix() << x, y, z, origin, 0.0, 0.0, 0.0, 1.0; };
  Eigen::Vector3d p(0.0, 0.0, ur3::d1);
  set(0, out, -n, up, p);
  const auto in_plane = [&](std::size_t i, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    set(i, c * out + s * up, -s * out + c * up, n, p);
  };
  in_plane(1, q[1]);
  p += ur3::a2 * f[1].linear().col(0);
  in_plane(2, q[1] + q[2]);
  p += ur3::a3 * f[2].linear().col(0) + ur3::d4 * n;
  in_plane(3, q[1] + q[2] + q[3]);
  const Eigen::Vector3d x4 = f[3].linear().col(0), z5 = -f[3].linear().col(1);
  p += ur3::d5 * z5;
  const double c5 = std::cos(q[4]), s5 = std::sin(q[4]);
  const Eigen::Vector3d x5 = c5 * x4 + s5 * n, y5 = -s5 * x4 + c5 * n;
  set(4, x5, y5, z5, p);
  p += ur3::d6 * y5;
  const double c6 = std::cos(q[5]), s6 = std::sin(q[5]);
  set(5, c6 * x5 - s6 * z5, -s6 * x5 - c6 * z5, y5, p);
  return f;
}

/// Forward kinematics: base_link_T_tool0 at joint angles `q` (rad).
inline Pose forward(const Joints& q) { return link_frames(q)[5]; }

/// Geometric Jacobian at joint angles `q` (rad). It maps joint speeds (rad/s) to the velocity of tool0 (m/s, rows 0-2)
/// and its angular velocity (rad/s, rows 3-5), both in base_link.
inline Eigen::Matrix<double, 6, 6> jacobian(const Joints& q) {
  const LinkFrames f = link_frames(q);
  Eigen::Matrix<double, 6, 6> j;
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Vector3d axis = f[i].linear().col(2);
    j.col(static_cast<Eigen::Index>(i)) << axis.cross(f[5].translation() - f[i].translation()), axis;
  }
  return j;
}

/// A quick test that takes a few nanoseconds: if false, no joint angles reach base_link_T_tool0; if true, there may be
/// some. It tests only whether the wrist's center is too far away for the stretched arm, or too near to the axis of the
/// base (closer than d4).
inline bool maybe_reachable(const Pose& base_link_T_tool0) {
  const Eigen::Vector3d p = base_link_T_tool0.translation() - ur3::d6 * base_link_T_tool0.linear().col(2);
  constexpr double far = -ur3::a2 - ur3::a3 + ur3::d5, slack = 1e-9;
  const double across_sq = p.x() * p.x() + p.y() * p.y(), height = p.z() - ur3::d1;
  return across_sq >= ur3::d4 * ur3::d4 - slack && across_sq + height * height <= far * far + ur3::d4 * ur3::d4 + slack;
}

namespace detail {

/// True if two solutions, with joints in (-pi, pi], are the same to within kSameSolution.
inline bool same_solution(const Joints& a, const Joints& b) {
  for (int j = 0; j < 6; ++j) {
    const double d = std::abs(a[j] - b[j]);
    if (d > kSameSolution && std::abs(d - kTwoPi) > kSameSolution) return false;
  }
  return true;
}

/// Joint 6 (rad) at a wrist singularity, where z5, the z axis of wrist 2, may have any direction in the arm's plane. It
/// is `desired`, or the nearest angle for which the links reach the wrist.
/// @param desired the angle to prefer (rad)
/// @param x6,y6 axes of tool0 in base_link
/// @param out horizontal direction of the arm's plane
/// @param u,v position (m) of the wrist's center relative to the shoulder, along `out` and upwards
inline double singular_q6(double desired, const Eigen::Vector3d& x6, const Eigen::Vector3d& y6,
                          const Eigen::Vector3d& out, double u, double v) {
  const Eigen::Vector3d z5 = -std::sin(desired) * x6 - std::cos(desired) * y6;
  const double w = std::hypot(u, v), bearing = std::atan2(v, u);
  if (w < 1e-12) return desired;
  // The two links must span the distance |w - d5 z5|, which grows with the angle between the wrist's bearing and z5.
  const auto angle_at = [&](double span) {
    return std::acos(std::clamp((w * w + ur3::d5 * ur3::d5 - span * span) / (2.0 * ur3::d5 * w), -1.0, 1.0));
  };
  const double angle = wrap(std::atan2(z5.z(), z5.dot(out)) - bearing);
  const double allowed = std::clamp(std::abs(angle), angle_at(ur3::a3 - ur3::a2), angle_at(-ur3::a2 - ur3::a3));
  if (allowed == std::abs(angle)) return desired;
  const double turned = bearing + std::copysign(allowed, angle);
  const Eigen::Vector3d z5_allowed = std::cos(turned) * out + std::sin(turned) * Eigen::Vector3d::UnitZ();
  return std::atan2(-z5_allowed.dot(x6), -z5_allowed.dot(y6));
}

}  // namespace detail

/// Calls body(q) for every inverse solution, with joints in (-pi, pi] (rad) and regardless of joint limits. The pose is
/// not checked. For the order of the solutions and for `q6_desired` see `inverse`.
template <typename Body>
void for_each_solution(const Pose& base_link_T_tool0, double q6_desired, Body&& body) {
  if (!maybe_reachable(base_link_T_tool0)) return;
  constexpr double slack = 1e-10;  // of a cosine, for rounding errors at the border of the reach
  const Eigen::Vector3d x6 = base_link_T_tool0.linear().col(0), y6 = base_link_T_tool0.linear().col(1),
                        z6 = base_link_T_tool0.linear().col(2);
  const Eigen::Vector3d wrist = base_link_T_tool0.translation() - ur3::d6 * z6;
  const double across = std::hypot(wrist.x(), wrist.y());
  if (ur3::d4 > across * (1.0 + slack)) return;
  const double bearing = std::atan2(wrist.y(), wrist.x()), half = std::acos(std::min(ur3::d4 / across, 1.0));
  std::array<Joints, 8> found;
  std::size_t n_found = 0;
  for (const double side : {1.0, -1.0}) {
    const double q1 = wrap(bearing + side * half - 0.5 * kPi);
    const double c1 = std::cos(q1), s1 = std::sin(q1);
    const Eigen::Vector3d out(-c1, -s1, 0.0), n(-s1, c1, 0.0);
    const double c5 = z6.dot(n), s5 = (z6 - c5 * n).norm();
    const bool singular = s5 < kWristSingularity;
    for (const double sign5 : {1.0, -1.0}) {
      const double q5 = wrap(std::atan2(sign5 * s5, c5));
      const double q6 =
          wrap(singular ? detail::singular_q6(q6_desired, x6, y6, out, wrist.dot(out), wrist.z() - ur3::d1)
                        : std::atan2(-sign5 * y6.dot(n), sign5 * x6.dot(n)));
      const Eigen::Vector3d z5 = -std::sin(q6) * x6 - std::cos(q6) * y6;
      const double q234 = std::atan2(z5.dot(out), -z5.z());
      // The planar arm: links a2 at angle q2 and a3 at angle q2 + q3 reach (u, v), along `out` and up from the
      // shoulder.
      const double u = (wrist - ur3::d5 * z5).dot(out), v = wrist.z() - ur3::d5 * z5.z() - ur3::d1;
      const double c3 = (u * u + v * v - ur3::a2 * ur3::a2 - ur3::a3 * ur3::a3) / (2.0 * ur3::a2 * ur3::a3);
      if (!(std::abs(c3) <= 1.0 + slack)) continue;
      const double bend = std::acos(std::clamp(c3, -1.0, 1.0)), towards = std::atan2(v, u);
      const double lag = std::atan2(ur3::a3 * std::sin(bend), ur3::a2 + ur3::a3 * std::cos(bend));
      for (const double sign3 : {1.0, -1.0}) {
        const double q3 = sign3 * bend, q2 = towards - sign3 * lag;
        Joints q;
        q << q1, wrap(q2), wrap(q3), wrap(q234 - q2 - q3), q5, q6;
        const auto end = found.begin() + static_cast<std::ptrdiff_t>(n_found);
        if (std::any_of(found.begin(), end, [&](const Joints& other) { return detail::same_solution(q, other); }))
          continue;
        found[n_found++] = q;
        body(static_cast<const Joints&>(q));
      }
    }
  }
}

/// Inverse kinematics: all joint angles (rad) that put tool0 at base_link_T_tool0. There are at most eight solutions,
/// and none if the pose is out of reach. Each joint is in (-pi, pi] if its limits allow that, otherwise at the nearest
/// equivalent angle within the limits. Solutions with a joint that has no angle within its limits are left out.
///
/// The order is fixed: by joint 1 (its two values differ by the side of the base on which the shoulder stands; the one
/// counter-clockwise of the wrist's bearing comes first), then by joint 5 (positive first), then by the elbow (positive
/// first). Solutions that coincide, at singularities of shoulder, elbow or wrist, are listed once. At a wrist
/// singularity (|sin q5| < kWristSingularity) joints 2, 3, 4 and 6 can move together without moving the tool. Joint 6
/// is then `q6_desired`, or the nearest angle that the links can reach.
/// @param base_link_T_tool0 the desired pose of tool0
/// @param limits of the joints
/// @param q6_desired joint 6 at wrist singularities (rad), usually its present angle
/// @throws InputError if the pose is not finite or not rigid (to 1e-6)
inline std::vector<Joints> inverse(const Pose& base_link_T_tool0, const JointLimits& limits = {},
                                   double q6_desired = 0.0) {
  check_input(is_rigid(base_link_T_tool0), "inverse: base_link_T_tool0 is not finite or not a rigid pose");
  check_input(std::isfinite(q6_desired), "inverse: q6_desired is not finite");
  std::vector<Joints> solutions;
  for_each_solution(base_link_T_tool0, q6_desired, [&](const Joints& q) {
    if (const auto allowed = nearest(q, q, limits)) solutions.push_back(*allowed);
  });
  return solutions;
}

}  // namespace agrisee::arm
