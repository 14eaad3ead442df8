// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/rigid_pose.hpp>

#include <Eigen/SVD>

#include <cmath>

namespace agrisee {

Eigen::Matrix3d nearest_orthonormal(const Pose& pose) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(pose.linear(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

double rigid_error(const Pose& pose) { return (pose.linear() - nearest_orthonormal(pose)).cwiseAbs().maxCoeff(); }

Pose made_rigid(const Pose& pose, const std::string& name, std::vector<std::string>* notes) {
  if (is_rigid(pose)) return pose;
  if (!pose.matrix().allFinite()) throw InputError(name + " is not a rigid transform: it holds NaN or infinity");
  const double error = rigid_error(pose);
  const std::string off = number_text(error, 2);
  if (!(error <= kRigidTolerance))
    throw InputError(name + " is not a rigid transform: its rotation matrix is off by " + off +
                     " (largest difference from the nearest rotation; up to 0.001 is put right). Is it rounded too "
                     "much, or scaled?");
  if (!(pose.linear().determinant() > 0.0))
    throw InputError(name + " is not a rigid transform: its axes are left-handed");
  Pose rigid = pose;
  rigid.linear() = nearest_orthonormal(pose);
  if (notes) notes->push_back(name + ": its rotation matrix was off by " + off + " and has been made orthonormal");
  return rigid;
}

Pose pose_from_matrix(const Unaligned<4, 4>& matrix, const std::string& name, std::vector<std::string>* notes) {
  if (!((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() <= 1e-6))
    throw InputError(name + " is not a rigid transform: its last row has to be 0 0 0 1. Is it transposed?");
  Pose pose = Pose::Identity();
  pose.linear() = matrix.topLeftCorner<3, 3>();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return made_rigid(pose, name, notes);
}

Pose pose_from_xyz_quaternion(const Eigen::Vector3d& xyz, const Unaligned<4, 1>& xyzw, const std::string& name,
                              std::vector<std::string>* notes) {
  if (!xyz.allFinite() || !xyzw.allFinite())
    throw InputError(name + " is not a rigid transform: it holds NaN or infinity");
  const double error = std::abs(xyzw.norm() - 1.0);
  const std::string off = number_text(error, 2);
  if (!(error <= kRigidTolerance))
    throw InputError(name + " is not a rigid transform: the length of its quaternion is off by " + off +
                     " (up to 0.001 is put right)");
  if (notes && error > 1e-6)
    notes->push_back(name + ": the length of its quaternion was off by " + off + " and has been normalized");
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized().toRotationMatrix();
  pose.translation() = xyz;
  return pose;
}

}  // namespace agrisee
