// SPDX-License-Identifier: BSD-3-Clause
// The UR3's joints as its drivers name them, in the order of Joints.
#pragma once

#include <agrisee/core/types.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string>

namespace agrisee::robot {

inline const std::array<std::string, 6> kJointNames{"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                                    "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};

/// The arm's joints (rad) in a sensor_msgs/JointState, in any order and among others; empty when one is missing.
template <typename Message>
std::optional<Joints> joints_of(const Message& message) {
  Joints joints;
  for (std::size_t j = 0; j < 6; ++j) {
    const auto at = std::find(message.name.begin(), message.name.end(), kJointNames[j]);
    const auto i = static_cast<std::size_t>(at - message.name.begin());
    if (at == message.name.end() || i >= message.position.size()) return std::nullopt;
    joints[static_cast<Eigen::Index>(j)] = message.position[i];
  }
  return joints;
}

}  // namespace agrisee::robot
