// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/rigid_pose.hpp>

#include "catch.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace {

const Pose kPose = pose_from_xyz_rpy({0.1, -0.2, 0.3}, {0.4, -0.5, 2.6});

/// The matrix with its entries rounded to some decimals, as a calibration tool prints it.
Eigen::Matrix4d rounded(const Pose& pose, double unit) {
  return ((pose.matrix() / unit).array().round() * unit).matrix();
}

}  // namespace

TEST_CASE("a matrix rounded to three to six decimals is made rigid, and that is said") {
  for (const double unit : {1e-3, 1e-4, 1e-5, 1e-6}) {
    INFO(unit);
    const Eigen::Matrix4d matrix = rounded(kPose, unit);
    std::vector<std::string> notes;
    const Pose pose = pose_from_matrix(matrix, "tool0_T_optical", &notes);
    CHECK(is_rigid(pose));
    CHECK(rigid_error(pose) < 1e-12);
    CHECK((pose.matrix() - kPose.matrix()).cwiseAbs().maxCoeff() < 2.0 * unit);
    Pose plain = Pose::Identity();
    plain.matrix() = matrix;
    const bool changed = !is_rigid(plain);
    REQUIRE(notes.size() == (changed ? 1u : 0u));
    if (unit >= 1e-4) CHECK(changed);
    if (changed) CHECK_THAT(notes[0], test::says("tool0_T_optical: its rotation matrix was off by "));
  }
}

TEST_CASE("a rigid pose stays as it is, to the bit") {
  std::vector<std::string> notes;
  CHECK(made_rigid(kPose, "pose", &notes).matrix() == kPose.matrix());
  CHECK(pose_from_matrix(kPose.matrix(), "pose", &notes).matrix() == kPose.matrix());
  CHECK(notes.empty());
}

TEST_CASE("the nearest rotation is taken") {
  Pose stretched = kPose;
  stretched.linear() *= 1.0002;  // the nearest rotation of s R is R
  CHECK(made_rigid(stretched, "pose").isApprox(kPose, 1e-12));
}

TEST_CASE("what is no rigid transform is refused by name and by how much it is off") {
  Pose bad = kPose;
  bad.linear() *= 1.01;  // the largest entry is 0.88
  CHECK_THROWS_WITH(made_rigid(bad, "world_T_base"),
                    test::says("world_T_base is not a rigid transform: its rotation matrix is off by 0.00"));
  CHECK_THROWS_AS(pose_from_matrix(rounded(kPose, 1e-1), "tool0_T_optical"), InputError);
  bad = kPose;
  bad.linear().col(0) *= -1.0;
  CHECK_THROWS_WITH(made_rigid(bad, "world_T_base"), test::says("left-handed"));
  bad = kPose;
  bad.translation().x() = std::nan("");
  CHECK_THROWS_WITH(made_rigid(bad, "world_T_base"), test::says("NaN"));
  CHECK_THROWS_WITH(pose_from_matrix(kPose.matrix().transpose(), "tool"), test::says("transposed"));
}

TEST_CASE("a pose from a quaternion") {
  const Eigen::Vector4d q = quaternion(kPose.linear()).coeffs();
  std::vector<std::string> notes;
  CHECK(pose_from_xyz_quaternion(kPose.translation(), q, "tool", &notes).isApprox(kPose, 1e-12));
  CHECK(notes.empty());
  CHECK(pose_from_xyz_quaternion(kPose.translation(), 1.0005 * q, "tool", &notes).isApprox(kPose, 1e-12));
  REQUIRE(notes.size() == 1);
  CHECK_THAT(notes[0], test::says("tool: the length of its quaternion was off by 0.0005"));
  CHECK_THROWS_WITH(pose_from_xyz_quaternion({0, 0, 0}, 1.1 * q, "tool"), test::says("off by 0.1"));
  const std::string not_finite = "tool is not a rigid transform: it holds NaN or infinity";
  CHECK_THROWS_WITH(pose_from_xyz_quaternion({0, 0, std::nan("")}, q, "tool"), not_finite);
  CHECK_THROWS_WITH(pose_from_xyz_quaternion({0, 0, 0}, std::nan("") * q, "tool"), not_finite);
}
