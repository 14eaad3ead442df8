// SPDX-License-Identifier: BSD-3-Clause
// A node's private parameters, typed strictly: a whole number serves as a real one, nothing else is converted.
#pragma once

#include <ros/node_handle.h>

#include "read_parameters.hpp"

namespace agrisee::robot {

/// Sets a field from the parameter of its name, where the server has one.
class Ros1Lookup {
 public:
  explicit Ros1Lookup(const ros::NodeHandle& handle) : handle_(handle) {}

  /// @throws ParameterError for a value of another type
  template <typename T>
  void operator()(const std::string& name, T& field) const {
    XmlRpc::XmlRpcValue value;
    if (!handle_.getParam(name, value)) return;
    using Value = XmlRpc::XmlRpcValue;
    const Value::Type type = value.getType();
    if constexpr (std::is_same_v<T, bool>) {
      expect(type == Value::TypeBoolean, name, "true or false");
      field = static_cast<bool&>(value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      expect(type == Value::TypeString, name, "a text");
      field = static_cast<std::string&>(value);
    } else if constexpr (std::is_integral_v<T>) {
      expect(type == Value::TypeInt, name, "a whole number");
      field = static_cast<T>(static_cast<int&>(value));
    } else {
      expect(type == Value::TypeDouble || type == Value::TypeInt, name, "a number");
      field = static_cast<T>(type == Value::TypeInt ? static_cast<int&>(value) : static_cast<double&>(value));
    }
  }

  /// @throws ParameterError naming a private parameter that is not among the `known` ones
  void refuse_unknown(const std::set<std::string>& known) const {
    std::vector<std::string> names;
    handle_.getParamNames(names);
    const std::string own = handle_.getNamespace() + "/";
    for (const std::string& name : names)
      if (name.compare(0, own.size(), own) == 0 && !known.count(name.substr(own.size())))
        throw ParameterError("unknown parameter '" + name + "'");
  }

 private:
  static void expect(bool ok, const std::string& name, const char* what) {
    if (!ok) throw ParameterError("parameter '" + name + "' has to be " + what);
  }

  ros::NodeHandle handle_;
};

}  // namespace agrisee::robot
