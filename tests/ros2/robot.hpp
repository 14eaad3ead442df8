// SPDX-License-Identifier: BSD-3-Clause
// A robot for the tests of the ROS 2 node: it sees spheres, goes where it is told, and hears what is published.
#pragma once

#include <agrisee/io/scene.hpp>

#include <filesystem>
#include <geometry_msgs/msg/pose_array.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <tf2_ros/buffer.h>
#include <trajectory_msgs/msg/joint_trajectory.hpp>
#include <visualization_msgs/msg/marker_array.hpp>

#include "joint_names.hpp"
#include "messages.hpp"
#include "spheres.hpp"

namespace agrisee::test {

using rclcpp::Parameter;

const std::vector<Sphere> kTwoFruit = {{{-0.03, 0.53, 0.2}, 0.035}, {{0.045, 0.54, 0.21}, 0.033}};

/// The scene file of a workcell with nothing in it.
inline std::string workcell_file() {
  io::SceneFile file;
  Workcell& w = file.workcell;
  w.name = "two fruit";
  w.scan_volume.extend({-0.17, 0.40, -0.02});
  w.scan_volume.extend({0.17, 0.72, 0.42});
  w.keep_out.push_back({"cluster", Cylinder{{0.015, 0.545, 0.21}, 0.30, 0.9}});
  w.sensor.intrinsics = sensor::intrinsics_from_fov(256, 192, deg(70), deg(55));
  const auto path = std::filesystem::temp_directory_path() / "agrisee_ros2_workcell.yaml";
  io::write_scene(path, file);
  return path.string();
}

/// The latest message of a topic, as RViz or a driver hears it.
template <typename Message>
class Ear {
 public:
  explicit Ear(const std::string& topic, rclcpp::QoS qos = rclcpp::QoS(10))
      : reader_(stand_in::subscribe<Message>(topic, qos.qos, [this](std::shared_ptr<const Message> m) {
          last = std::move(m);
          ++count;
        })) {}
  Ear(const Ear&) = delete;
  Ear& operator=(const Ear&) = delete;

  std::shared_ptr<const Message> last;
  int count = 0;

 private:
  std::shared_ptr<stand_in::Reader> reader_;
};

inline rclcpp::QoS latched() { return rclcpp::QoS(1).transient_local(); }

/// What a driver publishes.
template <typename Message>
class Mouth {
 public:
  explicit Mouth(const std::string& topic, rclcpp::QoS qos = rclcpp::SensorDataQoS())
      : topic_(topic), writer_(stand_in::advertise<Message>(topic, qos.qos)) {}
  void say(const Message& message) { stand_in::publish(topic_, writer_, message); }
  std::size_t listeners() const { return stand_in::readers(topic_, *writer_).size(); }

 private:
  std::string topic_;
  std::shared_ptr<stand_in::Writer> writer_;
};

/// The node as a container loads it, and the robot around it.
class Robot {
 public:
  explicit Robot(const std::vector<Parameter>& parameters = {}, const std::string& workcell = workcell_file()) {
    auto& graph = stand_in::graph();
    graph.log.clear();
    graph.now = 1000 * kSecond;
    graph.transform = [this](const std::string& target, const std::string& source, std::int64_t at) {
      return std::any(transform(target, source, at));
    };
    std::vector<Parameter> all{{"workcell", workcell}, {"max_views", 3}};
    for (const Parameter& p : parameters) all.push_back(p);
    node = std::static_pointer_cast<rclcpp_lifecycle::LifecycleNode>(
        graph.components.at("agrisee::robot::ScanNode")(rclcpp::NodeOptions().parameter_overrides(all)));
  }
  ~Robot() { stand_in::graph().transform = nullptr; }

  /// Up to where it listens. @return the state
  std::string bring_up() {
    if (node->configure().label() != "inactive") return node->get_current_state().label();
    return node->activate().label();
  }
  std_srvs::srv::Trigger::Response call(const std::string& name) {
    using Trigger = std_srvs::srv::Trigger;
    using Function = std::function<void(std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response>)>;
    const auto response = std::make_shared<Trigger::Response>();
    std::any_cast<const Function&>(stand_in::graph().services.at("/agrisee/" + name))(
        std::make_shared<Trigger::Request>(), response);
    return *response;
  }
  static void pass(double seconds) { stand_in::graph().now += std::llround(seconds * 1e9); }
  static bool said(const std::string& text) {
    for (const std::string& line : stand_in::graph().log)
      if (line.find(text) != std::string::npos) return true;
    return false;
  }
  bool status_says(const std::string& text) const { return status.last && status.last->data.find(text) == 0; }

  /// Stand where the node wants the sensor, long enough, and tell of it.
  void go() {
    world_T_optical_ = *goal();
    pass(1.0);
    tell_joints();
  }
  /// Stand elsewhere: `metres` along x from there.
  void go_astray(double metres) {
    go();
    world_T_optical_.translation().x() += metres;
  }
  std::optional<Pose> goal() const {
    if (!chosen.last) return std::nullopt;
    Pose pose = Pose::Identity();
    const auto& p = chosen.last->pose;
    pose.translation() << p.position.x, p.position.y, p.position.z;
    pose.linear() =
        Eigen::Quaterniond(p.orientation.w, p.orientation.x, p.orientation.y, p.orientation.z).toRotationMatrix();
    return pose;
  }
  void tell_joints() {
    std::copy_n(joint_goal.last->points.at(0).positions.begin(), 6, joints.data());
    tell_joints(joints);
  }
  void tell_joints(const Joints& at) {
    sensor_msgs::msg::JointState state;
    state.header.stamp = stamp();
    state.name = robot::joint_names(joint_prefix);
    std::reverse(state.name.begin(), state.name.end());
    state.position.assign(at.data(), at.data() + 6);
    std::reverse(state.position.begin(), state.position.end());
    joint_states.say(state);
  }
  /// Whether the last that the arm heard was to stand still at some joints.
  bool held_at(const Joints& at) const {
    if (!joint_goal.last || joint_goal.last->points.size() != 1) return false;
    const auto& point = joint_goal.last->points[0];
    const double seconds = point.time_from_start.sec + 1e-9 * point.time_from_start.nanosec;
    return std::equal(point.positions.begin(), point.positions.end(), at.data(), at.data() + 6) &&
           point.velocities == std::vector<double>(6, 0.0) && seconds > 0.0 && seconds <= 0.5;
  }
  sensor_msgs::msg::CameraInfo camera_info() const {
    sensor_msgs::msg::CameraInfo out;
    out.width = static_cast<std::uint32_t>(camera_.width);
    out.height = static_cast<std::uint32_t>(camera_.height);
    out.k = {camera_.fx, 0, camera_.cx, 0, camera_.fy, camera_.cy, 0, 0, 1};
    return out;
  }
  sensor_msgs::msg::Image image(const std::string& encoding, std::uint32_t bytes) const {
    sensor_msgs::msg::Image m;
    m.header.frame_id = "camera";
    m.header.stamp = stamp();
    m.width = static_cast<std::uint32_t>(camera_.width);
    m.height = static_cast<std::uint32_t>(camera_.height);
    m.encoding = encoding;
    m.step = m.width * bytes;
    m.data.resize(std::size_t{m.step} * m.height);
    return m;
  }
  /// A label image as of a detector that finds every fruit.
  sensor_msgs::msg::Image labels_of_fruit() const {
    auto m = image("8UC1", 1);
    for (std::size_t fruit = kTwoFruit.size(); fruit-- > 0;) {
      const sensor::DepthFrame alone = render({kTwoFruit[fruit]}, camera_, world_T_optical_);
      for (std::size_t i = 0; i < alone.depth.size(); ++i)
        if (sensor::DepthFrame::valid(alone.depth[i])) m.data[i] = static_cast<std::uint8_t>(fruit + 1);
    }
    return m;
  }
  /// The depth image and its camera info, as from where the sensor stands.
  void look() {
    const sensor::DepthFrame frame = render(kTwoFruit, camera_, world_T_optical_);
    auto m = image("32FC1", 4);
    std::memcpy(m.data.data(), frame.depth.data(), m.data.size());
    info.say(camera_info());
    depth.say(m);
  }
  /// The same as points in the optical frame.
  void look_by_points() {
    const sensor::DepthFrame frame = render(kTwoFruit, camera_, world_T_optical_);
    Cloud cloud;
    for (int v = 0; v < camera_.height; ++v)
      for (int u = 0; u < camera_.width; ++u)
        if (sensor::DepthFrame::valid(frame.at(u, v))) cloud.points.push_back(frame.point(u, v));
    sensor_msgs::msg::PointCloud2 m;
    robot::fill_cloud(m, cloud, {});
    m.header.frame_id = "camera";
    m.header.stamp = stamp();
    points.say(m);
  }
  static builtin_interfaces::msg::Time stamp() { return rclcpp::Time(stand_in::graph().now); }

  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node;
  std::string joint_prefix;
  Joints joints = Workcell().start;  ///< of the last goal that it went to (rad)
  bool lost = false;                 ///< tf does not know the sensor's pose
  Ear<trajectory_msgs::msg::JointTrajectory> joint_goal{"/agrisee/joint_goal"};
  Ear<geometry_msgs::msg::PoseStamped> chosen{"/agrisee/chosen_view"};
  Ear<std_msgs::msg::String> status{"/agrisee/status", latched()};
  Ear<geometry_msgs::msg::PoseArray> fruits{"/agrisee/fruits", latched()};
  Mouth<sensor_msgs::msg::CameraInfo> info{"/depth/camera_info"};
  Mouth<sensor_msgs::msg::Image> depth{"/depth/image"}, color{"/color/image"}, labels{"/labels/image"};
  Mouth<sensor_msgs::msg::PointCloud2> points{"/points"};
  Mouth<sensor_msgs::msg::JointState> joint_states{"/joint_states", rclcpp::QoS(10)};

 private:
  static constexpr std::int64_t kSecond = 1000000000;

  geometry_msgs::msg::TransformStamped transform(const std::string& target, const std::string& source,
                                                 std::int64_t at) const {
    if (lost || target != "world" || source != "camera" || at > stand_in::graph().now)
      throw tf2::TransformException("no transform from " + source + " to " + target);
    geometry_msgs::msg::TransformStamped out;
    const Eigen::Quaterniond q(world_T_optical_.linear());
    out.transform.translation.x = world_T_optical_.translation().x();
    out.transform.translation.y = world_T_optical_.translation().y();
    out.transform.translation.z = world_T_optical_.translation().z();
    out.transform.rotation.w = q.w();
    out.transform.rotation.x = q.x();
    out.transform.rotation.y = q.y();
    out.transform.rotation.z = q.z();
    return out;
  }

  sensor::Intrinsics camera_ = sensor::intrinsics_from_fov(256, 192, deg(70), deg(55));
  Pose world_T_optical_ = Pose::Identity();
};

}  // namespace agrisee::test
