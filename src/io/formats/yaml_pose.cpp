// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/yaml_pose.hpp"

#include <agrisee/core/rigid_pose.hpp>

#include "io/formats/text.hpp"

namespace agrisee::io {
namespace {

/// Rows of four numbers, three or four of them, or 16 numbers row by row.
Eigen::Matrix4d read_matrix(const YamlValue& value) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  const std::size_t size = value.list_size();
  if (size == 16) {
    const auto numbers = value.numbers<16>();
    for (int r = 0; r < 4; ++r) matrix.row(r) = numbers.segment<4>(4 * r).transpose();
  } else if (size == 3 || size == 4) {
    for (std::size_t r = 0; r < size; ++r)
      matrix.row(static_cast<Eigen::Index>(r)) = value.at(r).numbers<4>().transpose();
  } else {
    value.fail("expected four rows of four numbers");
  }
  return matrix;
}

}  // namespace

Eigen::Vector3d read_rpy(const YamlValue& value) {
  const Eigen::Vector3d rpy = value.numbers<3>();
  if (rpy.cwiseAbs().maxCoeff() > kTwoPi)
    value.fail("an angle of " + format(rpy.cwiseAbs().maxCoeff()) +
               " rad is more than a full turn: are the angles in degrees?");
  return rpy;
}

Pose read_pose(const YamlValue& value, std::vector<std::string>& warnings) {
  const std::string& name = value.key();
  if (!value.is_list()) value.check_keys({"xyz", "rpy", "quaternion", "matrix"});
  try {
    if (value.is_list()) return pose_from_matrix(read_matrix(value), name, &warnings);
    if (value.has("matrix")) {
      if (value.has("xyz") || value.has("rpy") || value.has("quaternion"))
        value.fail("expected either 'matrix', or 'xyz' with 'rpy' or 'quaternion'");
      return pose_from_matrix(read_matrix(value.at("matrix")), name, &warnings);
    }
    const Eigen::Vector3d xyz = value.at("xyz").numbers<3>();
    if (!value.has("quaternion")) return pose_from_xyz_rpy(xyz, read_rpy(value.at("rpy")));
    if (value.has("rpy")) value.fail("expected one of 'rpy' and 'quaternion'");
    return pose_from_xyz_quaternion(xyz, value.at("quaternion").numbers<4>(), name, &warnings);
  } catch (const InputError& e) {
    value.fail(std::string(e.what()).substr(name.size() + 1));  // the key is named by value.fail
  }
}

}  // namespace agrisee::io
