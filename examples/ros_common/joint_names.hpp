// SPDX-License-Identifier: BSD-3-Clause
// The UR3's joints as its drivers name them, in the order of Joints.
#pragma once

#include <agrisee/core/types.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace agrisee::robot {

inline const std::array<std::string, 6> kJointNames{"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                                    "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};

/// The six names behind a prefix, such as the `tf_prefix` of UR's drivers.
inline std::vector<std::string> joint_names(const std::string& prefix) {
  std::vector<std::string> names;
  for (const std::string& name : kJointNames) names.push_back(prefix + name);
  return names;
}

/// The arm's joints (rad) in a sensor_msgs/JointState, in any order and among others; empty when one is missing.
/// @param prefix of their names
template <typename Message>
std::optional<Joints> joints_of(const Message& message, const std::string& prefix = "") {
  Joints joints;
  for (std::size_t j = 0; j < 6; ++j) {
    const auto at = std::find(message.name.begin(), message.name.end(), prefix + kJointNames[j]);
    const auto i = static_cast<std::size_t>(at - message.name.begin());
    if (at == message.name.end() || i >= message.position.size()) return std::nullopt;
    joints[static_cast<Eigen::Index>(j)] = message.position[i];
  }
  return joints;
}

}  // namespace agrisee::robot
