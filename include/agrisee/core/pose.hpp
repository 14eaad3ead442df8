// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rigid poses. A pose named `a_T_b` transforms coordinates in frame b to frame a.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee {

/// A rigid transform in double precision. It is stored without alignment, so that programs and libraries compiled for
/// different vector instructions (-march) agree on its layout. It converts from and to Eigen::Isometry3d.
using Pose = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;

/// Pose from a translation (m) and roll, pitch, yaw (rad) as in URDF: rotations about the fixed axes x, y, z in turn.
inline Pose pose_from_xyz_rpy(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy) {
  Pose pose = Pose::Identity();
  pose.linear() =
      (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  pose.translation() = xyz;
  return pose;
}

/// A unit vector perpendicular to the unit vector `n`, by Duff et al., "Building an Orthonormal Basis, Revisited",
/// JCGT 6(1), 2017.
template <typename S>
Vector3<S> any_orthogonal(const Vector3<S>& n) {
  const S sign = std::copysign(S(1), n.z());
  const S a = S(-1) / (sign + n.z());
  return Vector3<S>(S(1) + sign * n.x() * n.x() * a, sign * n.x() * n.y() * a, -sign * n.x());
}

/// The pose world_T_optical of a sensor at `position` (m) that looks along `direction` (of any length).
///
/// The optical frame follows REP-103: z forward, x right, y down. With `roll` = 0 the image's y axis points down,
/// towards -z of world; `roll` (rad) then turns the camera about its own z axis. For a sensor that looks straight up or
/// down, its x axis is that of world.
/// @throws InputError if `direction` is zero or not finite
inline Pose look_along(const Eigen::Vector3d& position, const Eigen::Vector3d& direction, double roll = 0.0) {
  const double length = direction.norm();
  check_input(std::isfinite(length) && length > 0.0, "look_along: the viewing direction is zero or not finite");
  const Eigen::Vector3d z = direction / length;
  Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ());
  if (x.norm() < 1e-9)
    x = Eigen::Vector3d::UnitX();
  else
    x.normalize();
  Pose pose = Pose::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = position;
  if (roll != 0.0) pose.rotate(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()));
  return pose;
}

/// Hand-eye transform (tool0_T_optical) where none is given: the optical frame 30 mm ahead of tool0, axes parallel.
inline Pose default_hand_eye() { return pose_from_xyz_rpy({0.0, 0.0, 0.03}, Eigen::Vector3d::Zero()); }

/// True if all entries are finite and the rotation matrix is orthonormal (to 1e-6) and right-handed.
inline bool is_rigid(const Pose& pose) {
  return pose.matrix().allFinite() &&
         (pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
         pose.linear().determinant() > 0.0;
}

/// A rotation as a unit quaternion with w >= 0, which makes it unique (but for half turns).
inline Eigen::Quaterniond quaternion(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return q;
}

/// Angle (rad) of a pose's rotation. It is accurate for small angles too, unlike the arc cosine of the trace.
inline double angle_of(const Pose& pose) { return Eigen::AngleAxisd(Eigen::Quaterniond(pose.linear())).angle(); }

}  // namespace agrisee
