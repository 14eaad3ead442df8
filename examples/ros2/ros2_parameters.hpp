// SPDX-License-Identifier: BSD-3-Clause
// A node's parameters, typed strictly: a whole number serves as a real one, nothing else is converted.
#pragma once

#include <limits>
#include <map>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "read_parameters.hpp"

namespace agrisee::robot {

/// Declares the parameter of a field's name, with the field's value as its default, and sets the field to its value.
class Ros2Lookup {
 public:
  explicit Ros2Lookup(rclcpp_lifecycle::LifecycleNode& node) : node_(node) {}

  /// @throws ParameterError for a value of another type
  template <typename T>
  void operator()(const std::string& name, T& field) {
    using Type = rclcpp::ParameterType;
    const rclcpp::ParameterValue value = declared(name, field);
    const Type type = value.get_type();
    if constexpr (std::is_same_v<T, bool>) {
      expect(type == Type::PARAMETER_BOOL, name, "true or false");
      field = value.get<bool>();
    } else if constexpr (std::is_same_v<T, std::string>) {
      expect(type == Type::PARAMETER_STRING, name, "a text");
      field = value.get<std::string>();
    } else if constexpr (std::is_integral_v<T>) {
      expect(type == Type::PARAMETER_INTEGER, name, "a whole number");
      const auto whole = value.get<std::int64_t>();
      using Limits = std::numeric_limits<T>;
      expect(whole >= Limits::min() && whole <= Limits::max(), name, "a whole number of 32 bits");
      field = static_cast<T>(whole);
    } else {
      expect(type == Type::PARAMETER_DOUBLE || type == Type::PARAMETER_INTEGER, name, "a number");
      field = static_cast<T>(type == Type::PARAMETER_DOUBLE ? value.get<double>()
                                                            : static_cast<double>(value.get<std::int64_t>()));
    }
  }

  /// @throws ParameterError naming a parameter that was set but is neither `known` nor one of ROS's own
  void refuse_unknown(const std::set<std::string>& known) const {
    for (const auto& entry : node_.get_node_parameters_interface()->get_parameter_overrides())
      if (!known.count(entry.first) && !node_.has_parameter(entry.first) && entry.first.rfind("qos_overrides.", 0) != 0)
        throw ParameterError("unknown parameter '" + entry.first + "'");
  }

  /// The answer to those who set parameters of ours once they have been read.
  rcl_interfaces::msg::SetParametersResult refuse_change(const std::vector<rclcpp::Parameter>& changes) const {
    rcl_interfaces::msg::SetParametersResult answer;
    answer.successful = true;
    for (const rclcpp::Parameter& change : changes)
      if (read_.count(change.get_name())) {
        answer.successful = false;
        answer.reason =
            "'" + change.get_name() + "' is read when the node is configured: deactivate it and clean it up first";
      }
    return answer;
  }

  /// Forget the parameters that have the value of their default, so that another preset may give them another one.
  void forget_defaults() {
    for (const auto& [name, value] : defaults_)
      if (node_.has_parameter(name) && node_.get_parameter(name).get_parameter_value() == value)
        node_.undeclare_parameter(name);
    defaults_.clear();
  }

 private:
  template <typename T>
  rclcpp::ParameterValue declared(const std::string& name, const T& field) {
    read_.insert(name);
    if (node_.has_parameter(name)) return node_.get_parameter(name).get_parameter_value();
    using Stored = std::conditional_t<std::is_same_v<T, bool> || std::is_same_v<T, std::string>, T,
                                      std::conditional_t<std::is_integral_v<T>, std::int64_t, double>>;
    const rclcpp::ParameterValue value(static_cast<Stored>(field));
    rcl_interfaces::msg::ParameterDescriptor any_type;  // told by a message of our own
    any_type.dynamic_typing = true;
    defaults_.emplace(name, value);
    return node_.declare_parameter(name, value, any_type);
  }

  static void expect(bool ok, const std::string& name, const char* what) {
    if (!ok) throw ParameterError("parameter '" + name + "' has to be " + what);
  }

  rclcpp_lifecycle::LifecycleNode& node_;
  std::map<std::string, rclcpp::ParameterValue> defaults_;
  std::set<std::string> read_;  // names of all that were asked for
};

}  // namespace agrisee::robot
