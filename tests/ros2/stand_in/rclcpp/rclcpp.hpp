// SPDX-License-Identifier: BSD-3-Clause
// Stand-in for rclcpp, see ../graph.hpp: values, quality of service, time, and what connects a node.
#pragma once

#include <builtin_interfaces/msg/duration.hpp>
#include <builtin_interfaces/msg/time.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <variant>

#include "../graph.hpp"

namespace rclcpp {

enum ParameterType : std::uint8_t {
  PARAMETER_NOT_SET,
  PARAMETER_BOOL,
  PARAMETER_INTEGER,
  PARAMETER_DOUBLE,
  PARAMETER_STRING
};

class ParameterValue {
 public:
  ParameterValue() = default;
  explicit ParameterValue(bool value) : value_(value) {}
  explicit ParameterValue(std::int64_t value) : value_(value) {}
  explicit ParameterValue(double value) : value_(value) {}
  explicit ParameterValue(const std::string& value) : value_(value) {}

  ParameterType get_type() const { return static_cast<ParameterType>(value_.index()); }
  template <typename T>
  const T& get() const {
    return std::get<T>(value_);
  }
  bool operator==(const ParameterValue& other) const { return value_ == other.value_; }

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string> value_;
};

class Parameter {
 public:
  template <typename T>
  Parameter(std::string name, const T& value) : name_(std::move(name)), value_(value) {}
  Parameter(std::string name, const char* value) : name_(std::move(name)), value_(std::string(value)) {}
  Parameter(std::string name, int value) : name_(std::move(name)), value_(std::int64_t{value}) {}
  Parameter(std::string name, const ParameterValue& value) : name_(std::move(name)), value_(value) {}

  const std::string& get_name() const { return name_; }
  const ParameterValue& get_parameter_value() const { return value_; }

 private:
  std::string name_;
  ParameterValue value_;
};

class NodeOptions {
 public:
  const std::vector<Parameter>& parameter_overrides() const { return overrides_; }
  NodeOptions& parameter_overrides(const std::vector<Parameter>& overrides) {
    overrides_ = overrides;
    return *this;
  }

 private:
  std::vector<Parameter> overrides_;
};

class QoS {
 public:
  QoS(std::size_t depth) { qos.depth = depth; }  // implicit, as rclcpp's: a depth serves for the whole
  QoS& keep_last(std::size_t depth) {
    qos.depth = depth;
    return *this;
  }
  QoS& best_effort() {
    qos.reliable = false;
    return *this;
  }
  QoS& transient_local() {
    qos.transient_local = true;
    return *this;
  }

  stand_in::Qos qos;
};

class SensorDataQoS : public QoS {
 public:
  SensorDataQoS() : QoS(5) { best_effort(); }
};

class Duration {
 public:
  static Duration from_seconds(double seconds) { return Duration(std::llround(seconds * 1e9)); }
  std::int64_t nanoseconds() const { return nanoseconds_; }
  operator builtin_interfaces::msg::Duration() const {
    builtin_interfaces::msg::Duration message;
    message.sec = static_cast<std::int32_t>(nanoseconds_ / 1000000000);
    message.nanosec = static_cast<std::uint32_t>(nanoseconds_ % 1000000000);
    return message;
  }

 private:
  explicit Duration(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
  std::int64_t nanoseconds_;
};

class Time {
 public:
  explicit Time(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {
    if (nanoseconds < 0) throw std::runtime_error("a negative time");
  }
  Time(const builtin_interfaces::msg::Time& message)
      : nanoseconds_(message.sec * std::int64_t{1000000000} + message.nanosec) {
    if (message.sec < 0) throw std::runtime_error("cannot store a negative time point in rclcpp::Time");
  }
  double seconds() const { return 1e-9 * static_cast<double>(nanoseconds_); }
  std::int64_t nanoseconds() const { return nanoseconds_; }
  operator builtin_interfaces::msg::Time() const {
    builtin_interfaces::msg::Time message;
    message.sec = static_cast<std::int32_t>(nanoseconds_ / 1000000000);
    message.nanosec = static_cast<std::uint32_t>(nanoseconds_ % 1000000000);
    return message;
  }
  Time operator-(const Duration& d) const { return Time(nanoseconds_ - d.nanoseconds()); }

 private:
  std::int64_t nanoseconds_;
};

class Clock {
 public:
  using SharedPtr = std::shared_ptr<Clock>;
  Time now() const { return Time(stand_in::graph().now += stand_in::graph().clock_step); }
};

class Logger {};

class PublisherBase {
 public:
  using SharedPtr = std::shared_ptr<PublisherBase>;
  PublisherBase(std::string topic, std::shared_ptr<stand_in::Writer> writer)
      : topic_(std::move(topic)), writer_(std::move(writer)) {}
  virtual ~PublisherBase() = default;
  std::size_t get_subscription_count() const { return stand_in::readers(topic_, *writer_).size(); }

 protected:
  std::string topic_;
  std::shared_ptr<stand_in::Writer> writer_;
};

/// What lives as long as it is held.
struct SubscriptionBase {
  using SharedPtr = std::shared_ptr<SubscriptionBase>;
  std::shared_ptr<stand_in::Reader> reader;
};
struct MessageInfo {};
template <typename Message>
struct Subscription : SubscriptionBase {
  using SharedPtr = std::shared_ptr<Subscription>;
  /// Takes a message that waits before the executor does.
  bool take(Message& message, MessageInfo&) {
    if (reader->waiting.empty()) return false;
    message = *std::static_pointer_cast<const Message>(reader->waiting.front());
    reader->waiting.pop_front();
    return true;
  }
};
struct TimerBase {
  using SharedPtr = std::shared_ptr<TimerBase>;
  std::shared_ptr<std::function<void()>> callback;
};
struct ServiceBase {
  using SharedPtr = std::shared_ptr<ServiceBase>;
  explicit ServiceBase(std::string service) : name(std::move(service)) {}
  ~ServiceBase() { stand_in::graph().services.erase(name); }
  std::string name;
};

}  // namespace rclcpp

/// A line of the test's log; the compiler checks the arguments as printf's.
__attribute__((format(printf, 1, 2))) inline void stand_in_log(const char* format, ...) {
  char line[1024];
  __builtin_va_list arguments;
  __builtin_va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  __builtin_va_end(arguments);
  stand_in::graph().log.push_back(line);
}
#define RCLCPP_INFO(logger, ...) (static_cast<void>(logger), stand_in_log("[info] " __VA_ARGS__))
#define RCLCPP_WARN(logger, ...) (static_cast<void>(logger), stand_in_log("[warn] " __VA_ARGS__))
#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), stand_in_log("[error] " __VA_ARGS__))
#define RCLCPP_WARN_THROTTLE(logger, clock, milliseconds, ...) \
  (static_cast<void>(clock), static_cast<void>(milliseconds), RCLCPP_WARN(logger, __VA_ARGS__))
