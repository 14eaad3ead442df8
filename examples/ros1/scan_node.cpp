// SPDX-License-Identifier: BSD-3-Clause
// agrisee's whole pipeline as one ROS 1 node: its connections; what it does is in ../ros_common/node_core.hpp. Topics,
// services and parameters: docs/ros.md.
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/String.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>
#include <trajectory_msgs/JointTrajectory.h>
#include <visualization_msgs/MarkerArray.h>

#include "node_core.hpp"
#include "ros1_parameters.hpp"

namespace agrisee::robot {
namespace {

/// What NodeCore needs of ROS.
class Ros1 {
 public:
  using Image = sensor_msgs::Image;
  using CameraInfo = sensor_msgs::CameraInfo;
  using PointCloud2 = sensor_msgs::PointCloud2;
  using JointState = sensor_msgs::JointState;
  using PoseArray = geometry_msgs::PoseArray;
  using PoseStamped = geometry_msgs::PoseStamped;
  using MarkerArray = visualization_msgs::MarkerArray;
  using JointTrajectory = trajectory_msgs::JointTrajectory;
  using String = std_msgs::String;
  using ImagePtr = sensor_msgs::ImageConstPtr;
  using CameraInfoPtr = sensor_msgs::CameraInfoConstPtr;
  static constexpr bool kEmptyHolds = true;

  Ros1(ros::NodeHandle& handle, std::string world_frame)
      : handle_(handle), world_frame_(std::move(world_frame)), listener_(buffer_) {}

  template <typename Message>
  void advertise(const char* topic, const Message&, bool latched) {
    constexpr std::uint32_t kQueue = std::is_same_v<Message, String> ? 10 : 1;  // every status is for people to read
    publishers_[topic] = handle_.advertise<Message>(topic, kQueue, latched);
  }

  double now() const { return stamp().toSec(); }
  ros::Time stamp() const { return ros::Time::now(); }
  static double seconds(const ros::Time& stamp) { return stamp.toSec(); }
  static std::uint32_t nanoseconds(const ros::Time& stamp) { return stamp.nsec; }
  static ros::Duration duration(double seconds) { return ros::Duration(seconds); }
  Pose world_T(const std::string& frame, const ros::Time& stamp, double earlier) const {
    try {
      const ros::Time then = stamp - ros::Duration(earlier);
      return pose_of(buffer_.lookupTransform(world_frame_, frame, then, ros::Duration(0.2)).transform);
    } catch (const tf2::TransformException& e) {
      throw PoseUnknown(e.what());
    }
  }
  static const JointState* waiting_joints() { return nullptr; }  // not needed to hold
  template <typename Message>
  void publish(const char* topic, const Message& message) {
    publishers_.at(topic).publish(message);
  }
  std::size_t listeners(const char* topic) const { return publishers_.at(topic).getNumSubscribers(); }
  static void info(const std::string& text) { ROS_INFO("%s", text.c_str()); }
  static void warn(const std::string& text) { ROS_WARN("%s", text.c_str()); }
  static void left_out(const std::string& text) { ROS_WARN_THROTTLE(1.0, "%s", text.c_str()); }

 private:
  ros::NodeHandle& handle_;
  std::string world_frame_;
  std::map<std::string, ros::Publisher> publishers_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
};

class ScanNode {
 public:
  using Core = NodeCore<Ros1>;

  ScanNode() : private_("~"), setup_(read(private_)), ros_(private_, setup_.node.world_frame), core_(ros_, setup_) {
    NodeOutputs<Ros1>::list(
        [&](const char* topic, const auto& message, bool latched) { ros_.advertise(topic, message, latched); });
    // One frame is kept: while a view is planned, those that come are old by the time it is done.
    info_in_ = node_.subscribe("depth/camera_info", 1, &Core::take_info, &core_);
    image_in_ = node_.subscribe("depth/image", 1, &Core::take_image, &core_);
    if (setup_.node.channels.color) color_in_ = node_.subscribe("color/image", 5, &Core::take_color, &core_);
    if (setup_.node.channels.labels) labels_in_ = node_.subscribe("labels/image", 5, &Core::take_labels, &core_);
    points_in_ = node_.subscribe<sensor_msgs::PointCloud2>(
        "points", 1, [this](const sensor_msgs::PointCloud2ConstPtr& m) { core_.take_points(*m); });
    joints_in_ = node_.subscribe<sensor_msgs::JointState>(
        "joint_states", 1, [this](const sensor_msgs::JointStateConstPtr& m) { core_.take_joints(*m); });
    Core::services([&](const char* name, auto call) { services_.push_back(serve(name, call)); });
    timer_ = node_.createTimer(ros::Duration(0.5), [this](const ros::TimerEvent&) { core_.tick(); });
    core_.publish();
  }

 private:
  static NodeSetup read(const ros::NodeHandle& handle) {
    const Ros1Lookup lookup(handle);
    return read_setup(lookup, "/");
  }

  template <typename Call>
  ros::ServiceServer serve(const char* name, Call call) {
    return private_.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
        name, [this, call](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
          const Answer answer = core_.serve(call);
          response.success = answer.success;
          response.message = answer.message;
          return true;
        });
  }

  ros::NodeHandle node_, private_;
  NodeSetup setup_;
  Ros1 ros_;
  Core core_;
  ros::Subscriber info_in_, image_in_, color_in_, labels_in_, points_in_, joints_in_;
  std::vector<ros::ServiceServer> services_;
  ros::Timer timer_;
};

}  // namespace
}  // namespace agrisee::robot

int main(int argc, char** argv) {
  ros::init(argc, argv, "agrisee");
  try {
    agrisee::robot::ScanNode node;
    ros::spin();
  } catch (const agrisee::Error& e) {
    ROS_FATAL("%s", e.what());
    return 1;
  }
  return 0;
}
