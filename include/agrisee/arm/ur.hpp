// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Kinematics of the arms of Universal Robots (UR3 unless another model is given): forward kinematics, Jacobian, and
/// all inverse solutions in closed form.
///
/// Poses are those of tool0 in base_link (REP-103, x forward). The DH chain of the controller starts in the frame
/// `base`, which is base_link turned by pi about z; here this turn is part of the first joint. Link frames are those of
/// the robot's published description: each joint turns about the z axis of its own frame. Metres and radians.
/// Defined in `agrisee::agrisee`.
///
/// The inverse uses that three axes are parallel (shoulder lift, elbow, wrist 1; Hawkins, "Analytic Inverse Kinematics
/// for the Universal Robots UR-5/UR-10 Arms", 2013). Let n be the direction of these axes. The wrist's center lies d4
/// along n, which gives joint 1. The angle between n and the axis of the tool is joint 5. The direction of n in the
/// frame of the tool gives joint 6. The remaining joints form a planar arm with two links. All solutions take about 2
/// us.
#pragma once

#include <agrisee/arm/ur_model.hpp>
#include <agrisee/core/pose.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace agrisee::arm {

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
LinkFrames link_frames(const Joints& q, const UrModel& model = {});

/// Forward kinematics: base_link_T_tool0 at joint angles `q` (rad).
Pose forward(const Joints& q, const UrModel& model = {});

/// Geometric Jacobian at joint angles `q` (rad). It maps joint speeds (rad/s) to the velocity of tool0 (m/s, rows 0-2)
/// and its angular velocity (rad/s, rows 3-5), both in base_link.
Matrix6 jacobian(const Joints& q, const UrModel& model = {});

/// A quick test that takes a few nanoseconds: if false, no joint angles reach base_link_T_tool0; if true, there may be
/// some. It tests only whether the wrist's center is too far away for the stretched arm, or too near to the axis of the
/// base (closer than d4).
bool maybe_reachable(const Pose& base_link_T_tool0, const UrModel& model = {});

/// At most eight inverse solutions, without memory from the heap.
struct Solutions {
  std::array<Joints, 8> joints;                                ///< rad; the first `count` are set
  std::size_t count = 0;                                       ///< number of solutions
  const Joints* begin() const { return joints.data(); }        ///< the first solution
  const Joints* end() const { return joints.data() + count; }  ///< behind the last solution
};

/// All inverse solutions, with joints in (-pi, pi] (rad) and regardless of joint limits. The pose is not checked. For
/// the order of the solutions and for `q6_desired` see `inverse`.
Solutions solve(const Pose& base_link_T_tool0, double q6_desired, const UrModel& model = {});

/// Inverse kinematics: all joint angles (rad) that put tool0 at base_link_T_tool0. There are at most eight solutions,
/// and none if the pose is out of reach. Each joint is in (-pi, pi] if its limits allow that, otherwise at the nearest
/// equivalent angle within the limits. Solutions with a joint that has no angle within its limits are left out.
///
/// The order is fixed: by joint 1 (its two values differ by the side of the base on which the shoulder stands; the one
/// counter-clockwise of the wrist's bearing comes first), then by joint 5 (positive first), then by the elbow (positive
/// first). Solutions that coincide, at singularities of shoulder, elbow or wrist, are listed once. At a wrist
/// singularity (|sin q5| < kWristSingularity) joints 2, 3, 4 and 6 can move together without moving the tool. Joint 6
/// is then `q6_desired`, or the nearest angle that the links can reach. Near it rounding errors of the pose turn joint
/// 6 by some 1e-15 / |sin q5|, and a stretched or folded elbow by the square root of that; the tool stays where it is.
/// @param base_link_T_tool0 the desired pose of tool0
/// @param limits of the joints
/// @param q6_desired joint 6 at wrist singularities (rad), usually its present angle
/// @throws InputError if the pose is not finite or not rigid (to 1e-6)
std::vector<Joints> inverse(const Pose& base_link_T_tool0, const JointLimits& limits = {}, double q6_desired = 0.0,
                            const UrModel& model = {});

}  // namespace agrisee::arm
