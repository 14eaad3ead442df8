// SPDX-License-Identifier: BSD-3-Clause
// Stand-in for rclcpp_lifecycle, see ../graph.hpp: a publisher that is silent while its node is not active.
#pragma once

#include "../rclcpp/rclcpp.hpp"

namespace rclcpp_lifecycle {

struct ManagedEntity {
  virtual ~ManagedEntity() = default;
  bool active = false;
};

template <typename Message>
class LifecyclePublisher : public ManagedEntity, public rclcpp::PublisherBase {
 public:
  using SharedPtr = std::shared_ptr<LifecyclePublisher>;
  using PublisherBase::PublisherBase;
  void publish(const Message& message) {
    if (active) stand_in::publish(topic_, writer_, message);
  }
};

}  // namespace rclcpp_lifecycle
