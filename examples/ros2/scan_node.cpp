// SPDX-License-Identifier: BSD-3-Clause
// agrisee's whole pipeline as one ROS 2 node, for Humble and Jazzy: its connections; what it does is in
// ../ros_common/node_core.hpp. A component with a lifecycle. Topics, services and parameters, and what of this has been
// compiled and run where: docs/ros.md.
#include <chrono>
#include <geometry_msgs/msg/pose_array.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <rclcpp_lifecycle/lifecycle_publisher.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "node_core.hpp"
#include "ros2_parameters.hpp"

namespace agrisee::robot {

/// What NodeCore needs of ROS.
class Ros2 {
 public:
  using Image = sensor_msgs::msg::Image;
  using CameraInfo = sensor_msgs::msg::CameraInfo;
  using PointCloud2 = sensor_msgs::msg::PointCloud2;
  using JointState = sensor_msgs::msg::JointState;
  using PoseArray = geometry_msgs::msg::PoseArray;
  using PoseStamped = geometry_msgs::msg::PoseStamped;
  using MarkerArray = visualization_msgs::msg::MarkerArray;
  using JointTrajectory = trajectory_msgs::msg::JointTrajectory;
  using String = std_msgs::msg::String;
  using ImagePtr = Image::ConstSharedPtr;
  using CameraInfoPtr = CameraInfo::ConstSharedPtr;
  using Stamp = builtin_interfaces::msg::Time;
  static constexpr bool kEmptyHolds = false;

  Ros2(rclcpp_lifecycle::LifecycleNode& node, std::string world_frame)
      : node_(node), world_frame_(std::move(world_frame)), buffer_(node.get_clock()), listener_(buffer_) {}

  template <typename Message>
  void advertise(const std::string& topic, const Message&, bool latched) {
    rclcpp::QoS qos(1);
    if (latched) qos.transient_local();
    publishers_[topic] = node_.create_publisher<Message>("~/" + topic, qos);
  }

  /// Hands joint states to a callback.
  template <typename Callback>
  void listen_to_joints(const rclcpp::QoS& qos, Callback callback) {
    joints_in_ = node_.create_subscription<JointState>("joint_states", qos, std::move(callback));
  }
  void stop_listening() { joints_in_.reset(); }
  std::optional<JointState> waiting_joints() const {
    JointState message;
    rclcpp::MessageInfo info;
    if (!joints_in_ || !joints_in_->take(message, info)) return std::nullopt;
    return message;
  }

  double now() const { return node_.now().seconds(); }
  rclcpp::Time stamp() const { return node_.now(); }
  /// Of any stamp, as messages of a foreign clock have them: rclcpp::Time refuses negative ones.
  static double seconds(const Stamp& stamp) { return stamp.sec + 1e-9 * stamp.nanosec; }
  static std::uint32_t nanoseconds(const Stamp& stamp) { return stamp.nanosec; }
  static rclcpp::Duration duration(double seconds) { return rclcpp::Duration::from_seconds(seconds); }
  Pose world_T(const std::string& frame, const Stamp& stamp, double earlier) const {
    try {
      const rclcpp::Time then = rclcpp::Time(stamp) - duration(earlier);
      return pose_of(buffer_.lookupTransform(world_frame_, frame, then, duration(0.2)).transform);
    } catch (const tf2::TransformException& e) {
      throw PoseUnknown(e.what());
    }
  }
  template <typename Message>
  void publish(const char* topic, const Message& message) {
    // The type is that with which NodeCore had it advertised.
    std::static_pointer_cast<rclcpp_lifecycle::LifecyclePublisher<Message>>(publishers_.at(topic))->publish(message);
  }
  std::size_t listeners(const char* topic) const { return publishers_.at(topic)->get_subscription_count(); }
  void info(const std::string& text) const { RCLCPP_INFO(node_.get_logger(), "%s", text.c_str()); }
  void warn(const std::string& text) const { RCLCPP_WARN(node_.get_logger(), "%s", text.c_str()); }
  void left_out(const std::string& text) const {
    RCLCPP_WARN_THROTTLE(node_.get_logger(), *node_.get_clock(), 1000, "%s", text.c_str());
  }

 private:
  rclcpp_lifecycle::LifecycleNode& node_;
  std::string world_frame_;
  std::map<std::string, rclcpp::PublisherBase::SharedPtr> publishers_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  rclcpp::Subscription<JointState>::SharedPtr joints_in_;
};

/// Parameters are read when it is configured. While it is active it listens and serves; deactivated, it stops the scan
/// and keeps what was seen; cleaned up, it forgets. All callbacks are in the node's default group, so that no two run
/// at the same time, with any executor.
class ScanNode : public rclcpp_lifecycle::LifecycleNode {
 public:
  using Core = NodeCore<Ros2>;
  using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
  using State = rclcpp_lifecycle::State;

  explicit ScanNode(const rclcpp::NodeOptions& options) : LifecycleNode("agrisee", options), lookup_(*this) {
    on_set_ = add_on_set_parameters_callback([this](const std::vector<rclcpp::Parameter>& changes) {
      return core_ ? lookup_.refuse_change(changes) : rcl_interfaces::msg::SetParametersResult().set__successful(true);
    });
    Core::services([this](const std::string& name, auto call) { services_.push_back(serve("~/" + name, call)); });
  }

  CallbackReturn on_configure(const State&) override {
    try {
      const NodeSetup setup = read_setup(lookup_, ".");
      ros_ = std::make_unique<Ros2>(*this, setup.node.world_frame);
      core_ = std::make_unique<Core>(*ros_, setup);
    } catch (const Error& e) {
      RCLCPP_ERROR(get_logger(), "%s", e.what());
      forget();
      return CallbackReturn::FAILURE;
    }
    NodeOutputs<Ros2>::list([&](const char* topic, const auto& message, bool latched) {  //
      ros_->advertise(topic, message, latched);
    });
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_activate(const State& state) override {
    const CallbackReturn publishers = LifecycleNode::on_activate(state);
    if (publishers != CallbackReturn::SUCCESS) return publishers;
    listen();
    timer_ = create_wall_timer(std::chrono::milliseconds(500), [this] { core_->tick(); });
    active_ = true;
    core_->publish();
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_deactivate(const State& state) override {
    disconnect();
    return LifecycleNode::on_deactivate(state);
  }

  CallbackReturn on_cleanup(const State&) override {
    forget();
    return CallbackReturn::SUCCESS;
  }
  CallbackReturn on_shutdown(const State&) override {
    disconnect();
    forget();
    return CallbackReturn::SUCCESS;
  }
  CallbackReturn on_error(const State&) override {
    disconnect();
    forget();
    return CallbackReturn::SUCCESS;
  }

 private:
  using ImagePtr = Ros2::ImagePtr;

  /// Sensors often publish as best effort. Only the newest frame is kept, as those that arrive while a view is planned
  /// are out of date when it is done. Of colors and labels some are kept, as they come late.
  void listen() {
    const rclcpp::QoS newest = rclcpp::SensorDataQoS().keep_last(1), some = rclcpp::SensorDataQoS().keep_last(5);
    const ChannelParameters& channels = core_->parameters().channels;
    subscriptions_ = {
        create_subscription<Ros2::CameraInfo>("depth/camera_info", newest,
                                              [this](Ros2::CameraInfoPtr m) { core_->take_info(m); }),
        create_subscription<Ros2::Image>("depth/image", newest, [this](ImagePtr m) { core_->take_image(m); }),
        create_subscription<Ros2::PointCloud2>(
            "points", newest, [this](Ros2::PointCloud2::ConstSharedPtr m) { core_->take_points(*m); })};
    ros_->listen_to_joints(newest, [this](Ros2::JointState::ConstSharedPtr m) { core_->take_joints(*m); });
    if (channels.color)
      subscriptions_.push_back(
          create_subscription<Ros2::Image>("color/image", some, [this](ImagePtr m) { core_->take_color(m); }));
    if (channels.labels)
      subscriptions_.push_back(
          create_subscription<Ros2::Image>("labels/image", some, [this](ImagePtr m) { core_->take_labels(m); }));
  }

  /// Makes the arm hold and ends all subscriptions.
  void disconnect() {
    if (active_) core_->stop();
    active_ = false;
    timer_.reset();
    subscriptions_.clear();
    if (ros_) ros_->stop_listening();
  }

  void forget() {
    core_.reset();
    ros_.reset();
    lookup_.forget_defaults();
  }

  template <typename Call>
  rclcpp::ServiceBase::SharedPtr serve(const std::string& name, Call call) {
    using Trigger = std_srvs::srv::Trigger;
    return create_service<Trigger>(
        name, [this, call](const std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response> response) {
          const Answer answer = active_ ? core_->serve(call) : Answer{false, "the node is not active"};
          response->success = answer.success;
          response->message = answer.message;
        });
  }

  Ros2Lookup lookup_;
  OnSetParametersCallbackHandle::SharedPtr on_set_;
  std::unique_ptr<Ros2> ros_;
  std::unique_ptr<Core> core_;
  bool active_ = false;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace agrisee::robot

RCLCPP_COMPONENTS_REGISTER_NODE(agrisee::robot::ScanNode)
