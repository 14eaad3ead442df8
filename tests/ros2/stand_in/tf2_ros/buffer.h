// SPDX-License-Identifier: BSD-3-Clause
// Stand-in for tf2_ros, see ../graph.hpp: transforms that the test tells.
#pragma once

#include <geometry_msgs/msg/transform_stamped.hpp>

#include "../rclcpp/rclcpp.hpp"

namespace tf2 {

struct TransformException : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace tf2

namespace tf2_ros {

class Buffer {
 public:
  explicit Buffer(const rclcpp::Clock::SharedPtr&) {}
  geometry_msgs::msg::TransformStamped lookupTransform(const std::string& target, const std::string& source,
                                                       const rclcpp::Time& time, const rclcpp::Duration&) const {
    return std::any_cast<geometry_msgs::msg::TransformStamped>(
        stand_in::graph().transform(target, source, time.nanoseconds()));
  }
};

}  // namespace tf2_ros
