// SPDX-License-Identifier: BSD-3-Clause
// Stand-in for rclcpp_components, see ../graph.hpp: a node that a container can make by its name.
#pragma once

#include "../rclcpp/rclcpp.hpp"

#define RCLCPP_COMPONENTS_REGISTER_NODE(Node)                                                            \
  static const bool registered_component = [] {                                                          \
    stand_in::graph().components[#Node] = [](const std::any& options) {                                  \
      return std::shared_ptr<void>(std::make_shared<Node>(std::any_cast<rclcpp::NodeOptions>(options))); \
    };                                                                                                   \
    return true;                                                                                         \
  }();
