// SPDX-License-Identifier: BSD-3-Clause
// Stand-in for rclcpp_lifecycle, see ../graph.hpp: a node with parameters and states.
#pragma once

#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <rcl_interfaces/msg/set_parameters_result.hpp>

#include "lifecycle_publisher.hpp"

namespace rclcpp_lifecycle {

class State {
 public:
  explicit State(std::string label) : label_(std::move(label)) {}
  std::string label() const { return label_; }

 private:
  std::string label_;
};

namespace node_interfaces {

struct LifecycleNodeInterface {
  enum class CallbackReturn : std::uint8_t { SUCCESS, FAILURE, ERROR };
  virtual ~LifecycleNodeInterface() = default;
  virtual CallbackReturn on_configure(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_shutdown(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_error(const State&) { return CallbackReturn::FAILURE; }
};

/// What NodeParametersInterface tells of the parameters that were given when the node was made.
struct Parameters {
  const std::map<std::string, rclcpp::ParameterValue>& get_parameter_overrides() const { return overrides; }
  std::map<std::string, rclcpp::ParameterValue> overrides, declared;
};

}  // namespace node_interfaces

class LifecycleNode : public node_interfaces::LifecycleNodeInterface {
 public:
  LifecycleNode(std::string name, const rclcpp::NodeOptions& options) : name_(std::move(name)) {
    for (const rclcpp::Parameter& p : options.parameter_overrides())
      parameters_->overrides[p.get_name()] = p.get_parameter_value();
    const auto sim_time = parameters_->overrides.find("use_sim_time");  // every node has it
    parameters_->declared["use_sim_time"] =
        sim_time == parameters_->overrides.end() ? rclcpp::ParameterValue(false) : sim_time->second;
  }
  LifecycleNode(const LifecycleNode&) = delete;
  LifecycleNode& operator=(const LifecycleNode&) = delete;

  rclcpp::Clock::SharedPtr get_clock() { return clock_; }
  rclcpp::Time now() const { return clock_->now(); }
  rclcpp::Logger get_logger() const { return {}; }

  bool has_parameter(const std::string& name) const { return parameters_->declared.count(name) == 1; }
  const rclcpp::ParameterValue& declare_parameter(const std::string& name, const rclcpp::ParameterValue& value,
                                                  const rcl_interfaces::msg::ParameterDescriptor& descriptor) {
    if (has_parameter(name)) throw std::logic_error("declared twice: " + name);
    if (!descriptor.dynamic_typing) throw std::logic_error("the stand-in has dynamic typing only: " + name);
    const auto given = parameters_->overrides.find(name);
    const rclcpp::ParameterValue first = given == parameters_->overrides.end() ? value : given->second;
    if (!asked({name, first}).successful) throw std::invalid_argument("refused: " + name);
    return parameters_->declared[name] = first;
  }
  void undeclare_parameter(const std::string& name) {
    if (parameters_->declared.erase(name) == 0) throw std::logic_error("not declared: " + name);
  }
  rclcpp::Parameter get_parameter(const std::string& name) const { return {name, parameters_->declared.at(name)}; }
  rcl_interfaces::msg::SetParametersResult set_parameter(const rclcpp::Parameter& parameter) {
    auto& value = parameters_->declared.at(parameter.get_name());
    auto answer = asked(parameter);
    if (answer.successful) value = parameter.get_parameter_value();
    return answer;
  }
  struct OnSetParametersCallbackHandle {
    using SharedPtr = std::shared_ptr<OnSetParametersCallbackHandle>;
    std::function<rcl_interfaces::msg::SetParametersResult(const std::vector<rclcpp::Parameter>&)> callback;
  };
  template <typename Callback>
  OnSetParametersCallbackHandle::SharedPtr add_on_set_parameters_callback(Callback callback) {
    auto handle = std::make_shared<OnSetParametersCallbackHandle>();
    handle->callback = callback;
    on_set_ = handle;
    return handle;
  }
  std::shared_ptr<node_interfaces::Parameters> get_node_parameters_interface() { return parameters_; }

  template <typename Message>
  std::shared_ptr<LifecyclePublisher<Message>> create_publisher(const std::string& name, const rclcpp::QoS& qos) {
    const std::string topic = stand_in::resolved(name_, name);
    auto made = std::make_shared<LifecyclePublisher<Message>>(topic, stand_in::advertise<Message>(topic, qos.qos));
    managed_.push_back(made);
    return made;
  }
  template <typename Message, typename Callback>
  std::shared_ptr<rclcpp::Subscription<Message>> create_subscription(const std::string& name, const rclcpp::QoS& qos,
                                                                     Callback callback) {
    auto made = std::make_shared<rclcpp::Subscription<Message>>();
    made->reader = stand_in::subscribe<Message>(stand_in::resolved(name_, name), qos.qos, callback);
    return made;
  }
  template <typename Service, typename Callback>
  rclcpp::ServiceBase::SharedPtr create_service(const std::string& name, Callback callback) {
    using Function =
        std::function<void(std::shared_ptr<typename Service::Request>, std::shared_ptr<typename Service::Response>)>;
    auto made = std::make_shared<rclcpp::ServiceBase>(stand_in::resolved(name_, name));
    stand_in::graph().services[made->name] = Function(callback);
    return made;
  }
  template <typename Period, typename Callback>
  rclcpp::TimerBase::SharedPtr create_wall_timer(Period, Callback callback) {
    auto made = std::make_shared<rclcpp::TimerBase>();
    made->callback = std::make_shared<std::function<void()>>(callback);
    stand_in::graph().timers.push_back(made->callback);
    return made;
  }

  const State& get_current_state() const { return state_; }
  const State& configure() { return go("unconfigured", "inactive", &LifecycleNodeInterface::on_configure); }
  const State& activate() { return go("inactive", "active", &LifecycleNodeInterface::on_activate); }
  const State& deactivate() { return go("active", "inactive", &LifecycleNodeInterface::on_deactivate); }
  const State& cleanup() { return go("inactive", "unconfigured", &LifecycleNodeInterface::on_cleanup); }
  const State& shutdown() { return go(state_.label(), "finalized", &LifecycleNodeInterface::on_shutdown); }

  CallbackReturn on_activate(const State&) override { return activate_publishers(true); }
  CallbackReturn on_deactivate(const State&) override { return activate_publishers(false); }

 private:
  using Transition = CallbackReturn (LifecycleNodeInterface::*)(const State&);

  const State& go(const std::string& from, const std::string& to, Transition transition) {
    if (state_.label() != from) throw std::logic_error("not from " + state_.label() + " to " + to);
    CallbackReturn result = CallbackReturn::ERROR;
    try {
      result = (this->*transition)(state_);
    } catch (const std::exception& e) {
      stand_in_log("[error] a transition threw: %s", e.what());
    }
    if (result == CallbackReturn::SUCCESS) state_ = State(to);
    if (result == CallbackReturn::ERROR)
      state_ = State(on_error(state_) == CallbackReturn::SUCCESS ? "unconfigured" : "finalized");
    return state_;
  }
  CallbackReturn activate_publishers(bool active) {
    for (const auto& weak : managed_)
      if (const auto entity = weak.lock()) entity->active = active;
    return CallbackReturn::SUCCESS;
  }

  /// The answer of the callback, as long as its handle lives; it is asked at declarations, too.
  rcl_interfaces::msg::SetParametersResult asked(const rclcpp::Parameter& parameter) const {
    if (const auto handle = on_set_.lock()) return handle->callback({parameter});
    return rcl_interfaces::msg::SetParametersResult().set__successful(true);
  }

  std::string name_;
  std::weak_ptr<OnSetParametersCallbackHandle> on_set_;
  State state_{"unconfigured"};
  rclcpp::Clock::SharedPtr clock_ = std::make_shared<rclcpp::Clock>();
  std::shared_ptr<node_interfaces::Parameters> parameters_ = std::make_shared<node_interfaces::Parameters>();
  std::vector<std::weak_ptr<ManagedEntity>> managed_;
};

}  // namespace rclcpp_lifecycle
