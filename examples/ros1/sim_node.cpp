// SPDX-License-Identifier: BSD-3-Clause
// A UR3 that holds an L515 before a scene, for a desk without a robot: takes joint goals, publishes joint states, the
// mounting's transforms, and depth frames whenever the arm stands. Topics and parameters: docs/ros.md.
#include <agrisee/io/scene.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/traced_scene.hpp>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/TransformStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <trajectory_msgs/JointTrajectory.h>

#include "joint_names.hpp"
#include "messages.hpp"
#include "ros1_parameters.hpp"

namespace agrisee::robot {
namespace {

class SimNode {
 public:
  SimNode()
      : private_("~"), options_(read_options(private_)), file_(io::read_scene(options_.scene)), world_(file_.scene) {
    file_.workcell.sensor.check();
    from_ = to_ = file_.workcell.start;
    joint_states_ = node_.advertise<sensor_msgs::JointState>("joint_states", 10);
    image_ = node_.advertise<sensor_msgs::Image>("depth/image", 1);
    info_ = node_.advertise<sensor_msgs::CameraInfo>("depth/camera_info", 1, true);
    points_ = node_.advertise<sensor_msgs::PointCloud2>("points", 1);
    goals_in_ = node_.subscribe("joint_goal", 1, &SimNode::take_goal, this);
    fixed_.sendTransform({transform("world", "base_link", file_.workcell.world_T_base),
                          transform("tool0", kOpticalFrame, file_.workcell.tool0_T_optical)});
    arm_timer_ = node_.createTimer(ros::Duration(0.02), [this](const ros::TimerEvent&) { publish_joints(); });
    sensor_timer_ = node_.createTimer(ros::Duration(1.0 / options_.rate), [this](const ros::TimerEvent&) { look(); });
  }

 private:
  static constexpr const char* kOpticalFrame = "camera_depth_optical_frame";

  struct Options {
    std::string scene, noise = "none", output = "32FC1";
    int seed = 0;
    double rate = 5.0, hurry = 1.0;
  };

  static Options read_options(const ros::NodeHandle& handle) {
    const Ros1Lookup lookup(handle);
    Options o;
    std::set<std::string> known;
    const auto read = [&](const char* name, auto& field) {
      lookup(name, field);
      known.insert(name);
    };
    read("scene", o.scene);
    read("noise", o.noise);
    read("output", o.output);
    read("seed", o.seed);
    read("rate", o.rate);
    read("hurry", o.hurry);
    lookup.refuse_unknown(known);
    if (o.scene.empty()) throw ParameterError("parameter 'scene' has to name a scene file");
    if (o.output != "32FC1" && o.output != "16UC1" && o.output != "points")
      throw ParameterError("output must be 32FC1, 16UC1 or points, got " + o.output);
    if (o.noise == "rough") throw ParameterError("noise 'rough' is of the poses, too; they come from tf here");
    study::parse_noise(o.noise);
    check_parameter(o.rate > 0.0 && o.rate <= 100.0, "rate", "in (0, 100]", o.rate);
    check_parameter(o.hurry > 0.0, "hurry", "positive", o.hurry);
    check_parameter(o.seed >= 0, "seed", ">= 0", o.seed);
    return o;
  }

  static geometry_msgs::TransformStamped transform(const char* parent, const char* child, const Pose& pose) {
    geometry_msgs::TransformStamped t;
    t.header.stamp = ros::Time::now();
    t.header.frame_id = parent;
    t.child_frame_id = child;
    const auto p = pose_message<geometry_msgs::Pose>(pose);
    t.transform.translation = point_message<geometry_msgs::Vector3>(pose.translation());
    t.transform.rotation = p.orientation;
    return t;
  }

  /// Where the arm is: on a straight line in joint space, smoothly off and on.
  Joints joints_at(const ros::Time& time) const {
    const double t = duration_ > 0.0 ? std::clamp((time - begun_).toSec() / duration_, 0.0, 1.0) : 1.0;
    return t < 1.0 ? Joints(from_ + t * t * (3.0 - 2.0 * t) * (to_ - from_)) : to_;
  }
  bool moving(const ros::Time& time) const { return (time - begun_).toSec() < duration_; }

  void take_goal(const trajectory_msgs::JointTrajectoryConstPtr& goal) {
    const ros::Time now = ros::Time::now();
    from_ = joints_at(now);
    begun_ = now;
    duration_ = 0.0;
    if (goal->points.empty()) {  // hold
      to_ = from_;
      return;
    }
    sensor_msgs::JointState last;
    last.name = goal->joint_names;
    last.position = goal->points.back().positions;
    const auto joints = joints_of(last);
    if (!joints || !joints->allFinite()) {
      ROS_WARN("A goal that does not name the six joints is left out");
      to_ = from_;
      return;
    }
    to_ = *joints;
    duration_ = goal->points.back().time_from_start.toSec() / options_.hurry;
    ++goals_;
  }

  void publish_joints() {
    sensor_msgs::JointState m;
    m.header.stamp = stamp_ = ros::Time::now();
    m.name.assign(kJointNames.begin(), kJointNames.end());
    const Joints q = joints_at(stamp_);
    m.position.assign(q.data(), q.data() + 6);
    joint_states_.publish(m);
  }

  /// A frame, stamped as the last joint states were; of a standing arm the same again and again.
  void look() {
    if (stamp_.isZero() || moving(stamp_)) return;
    const Joints q = joints_at(stamp_);
    if (!frame_ || q != frame_joints_) {
      const Pose world_T_optical = optical_pose(file_.workcell, q);
      // View k of `agrisee scan` draws its noise by k: here that is the goal's number.
      const std::uint64_t view = goals_ > 0 ? goals_ - 1 : 0;
      frame_ = study::capture(world_, file_.workcell.sensor, world_T_optical, study::parse_noise(options_.noise),
                              static_cast<std::uint64_t>(options_.seed), view)
                   .frame;
      frame_joints_ = q;
    }
    std_msgs::Header header;
    header.stamp = stamp_;
    header.frame_id = kOpticalFrame;
    info_.publish(camera_info(header));
    if (options_.output == "points")
      points_.publish(points_message(header));
    else
      image_.publish(image_message(header));
  }

  sensor_msgs::CameraInfo camera_info(const std_msgs::Header& header) const {
    const sensor::Intrinsics& k = frame_->intrinsics;
    sensor_msgs::CameraInfo m;
    m.header = header;
    m.width = static_cast<std::uint32_t>(k.width);
    m.height = static_cast<std::uint32_t>(k.height);
    m.distortion_model = "plumb_bob";
    m.D.assign(5, 0.0);
    m.K = {k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0};
    m.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    m.P = {k.fx, 0.0, k.cx, 0.0, 0.0, k.fy, k.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
    return m;
  }

  sensor_msgs::Image image_message(const std_msgs::Header& header) const {
    const bool millimetres = options_.output == "16UC1";
    sensor_msgs::Image m;
    m.header = header;
    m.width = static_cast<std::uint32_t>(frame_->intrinsics.width);
    m.height = static_cast<std::uint32_t>(frame_->intrinsics.height);
    m.encoding = options_.output;
    m.is_bigendian = interop::detail::host_is_big_endian();
    const std::size_t bytes = millimetres ? 2 : 4;
    m.step = m.width * static_cast<std::uint32_t>(bytes);
    m.data.resize(frame_->depth.size() * bytes);
    for (std::size_t i = 0; i < frame_->depth.size(); ++i) {
      const float z = frame_->depth[i];
      const auto mm = static_cast<std::uint16_t>(std::lround(1000.0f * std::clamp(z, 0.0f, 65.0f)));
      std::memcpy(m.data.data() + i * bytes, millimetres ? static_cast<const void*>(&mm) : &z, bytes);
    }
    return m;
  }

  /// Organised, NaN where there is no return.
  sensor_msgs::PointCloud2 points_message(const std_msgs::Header& header) const {
    const sensor::Intrinsics& k = frame_->intrinsics;
    Cloud cloud;
    for (int v = 0; v < k.height; ++v)
      for (int u = 0; u < k.width; ++u)
        cloud.points.push_back(sensor::DepthFrame::valid(frame_->at(u, v))
                                   ? frame_->point(u, v)
                                   : Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    sensor_msgs::PointCloud2 m;
    m.header = header;
    fill_cloud(m, cloud, {});
    m.width = static_cast<std::uint32_t>(k.width);
    m.height = static_cast<std::uint32_t>(k.height);
    m.row_step = m.width * m.point_step;
    m.is_dense = false;
    return m;
  }

  ros::NodeHandle node_, private_;
  Options options_;
  io::SceneFile file_;
  study::TracedScene world_;
  Joints from_, to_, frame_joints_ = Joints::Zero();
  ros::Time begun_, stamp_;
  double duration_ = 0.0;
  std::uint64_t goals_ = 0;
  std::optional<sensor::DepthFrame> frame_;
  tf2_ros::StaticTransformBroadcaster fixed_;
  ros::Publisher joint_states_, image_, info_, points_;
  ros::Subscriber goals_in_;
  ros::Timer arm_timer_, sensor_timer_;
};

}  // namespace
}  // namespace agrisee::robot

int main(int argc, char** argv) {
  ros::init(argc, argv, "agrisee_sim");
  try {
    agrisee::robot::SimNode node;
    ros::spin();
  } catch (const agrisee::Error& e) {
    ROS_FATAL("%s", e.what());
    return 1;
  }
  return 0;
}
