// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Rigid poses. A pose named `a_T_b` transforms coordinates in frame b to frame a.
#pragma once

#include <agrisee/core/error.hpp>
#include <agrisee/core/types.hpp>

#include <cmath>

namespace agrisee {

/// A rigid transform. It is stored without alignment, so that programs and libraries compiled for
/// different vector instructions (-march) agree on its layout. It converts from and to
/// Eigen::Isometry3d.
template <typename S>
using Transform = Eigen::Transform<S, 3, Eigen::Isometry, Eigen::DontAlign>;

/// A rigid transform in double precision.
using Pose = Transform<double>;

namespace detail {
/// The type S, in a parameter that takes no part in deducing S.
template <typename S>
struct Same {
  using type = S;
};
/// A vector that any expression or list of three numbers converts to.
template <typename S>
using AnyVector3 = Vector3<typename Same<S>::type>;
}  // namespace detail

// These functions are templates so that a program compiles, of Eigen's rotations, only what it uses.

/// Pose from a translation (m) and roll, pitch, yaw (rad) as in URDF: rotations about the fixed axes x, y, z in turn.
template <typename S = double>
Transform<S> pose_from_xyz_rpy(const detail::AnyVector3<S>& xyz, const detail::AnyVector3<S>& rpy) {
  using Turn = Eigen::AngleAxis<S>;
  Transform<S> pose = Transform<S>::Identity();
  pose.linear() =
      (Turn(rpy.z(), Vector3<S>::UnitZ()) * Turn(rpy.y(), Vector3<S>::UnitY()) * Turn(rpy.x(), Vector3<S>::UnitX()))
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
template <typename S = double>
Transform<S> look_along(const detail::AnyVector3<S>& position, const detail::AnyVector3<S>& direction,
                        typename detail::Same<S>::type roll = 0) {
  const S length = direction.norm();
  check_input(std::isfinite(length) && length > 0, "look_along: the viewing direction is zero or not finite");
  const Vector3<S> z = direction / length;
  Vector3<S> x = z.cross(Vector3<S>::UnitZ());
  if (x.norm() < S(1e-9))
    x = Vector3<S>::UnitX();
  else
    x.normalize();
  Transform<S> pose = Transform<S>::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = position;
  if (roll != 0) pose.rotate(Eigen::AngleAxis<S>(roll, Vector3<S>::UnitZ()));
  return pose;
}

/// Hand-eye transform (tool0_T_optical) where none is given: the optical frame 30 mm ahead of tool0, axes parallel.
inline Pose default_hand_eye() {
  Pose tool0_T_optical = Pose::Identity();
  tool0_T_optical(2, 3) = 0.03;
  return tool0_T_optical;
}

/// True if all entries are finite and the rotation matrix is orthonormal (to 1e-6) and right-handed.
template <typename S, int Options>
bool is_rigid(const Eigen::Transform<S, 3, Eigen::Isometry, Options>& pose) {
  return pose.matrix().allFinite() &&
         (pose.linear() * pose.linear().transpose() - Matrix3<S>::Identity()).cwiseAbs().maxCoeff() < S(1e-6) &&
         pose.linear().determinant() > 0;
}

/// A rotation matrix as a unit quaternion with w >= 0, which makes it unique (but for half turns).
template <typename Derived>
Eigen::Quaternion<typename Derived::Scalar> quaternion(const Eigen::MatrixBase<Derived>& rotation) {
  Eigen::Quaternion<typename Derived::Scalar> q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

/// Angle (rad) of a pose's rotation. It is accurate for small angles too, unlike the arc cosine of the trace.
template <typename S, int Options>
S angle_of(const Eigen::Transform<S, 3, Eigen::Isometry, Options>& pose) {
  return Eigen::AngleAxis<S>(Eigen::Quaternion<S>(pose.linear())).angle();
}

}  // namespace agrisee
