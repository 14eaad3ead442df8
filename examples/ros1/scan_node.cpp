// SPDX-License-Identifier: BSD-3-Clause
// agrisee's whole pipeline as one ROS 1 node. Topics, services and parameters: docs/ros.md.
#include <agrisee/io/scene.hpp>

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

#include "joint_names.hpp"
#include "messages.hpp"
#include "ros1_parameters.hpp"
#include "scan_session.hpp"

namespace agrisee::robot {
namespace {

class ScanNode {
 public:
  ScanNode() : private_("~"), own_(read_own(private_)), session_(make_session(private_, own_)), listener_(buffer_) {
    cloud_ = private_.advertise<sensor_msgs::PointCloud2>("cloud", 1, true);
    candidates_ = private_.advertise<geometry_msgs::PoseArray>("candidate_views", 1, true);
    chosen_ = private_.advertise<geometry_msgs::PoseStamped>("chosen_view", 1, true);
    view_markers_ = private_.advertise<visualization_msgs::MarkerArray>("view_markers", 1, true);
    fruits_ = private_.advertise<geometry_msgs::PoseArray>("fruits", 1, true);
    bodies_ = private_.advertise<geometry_msgs::PoseArray>("bodies", 1, true);
    fruit_markers_ = private_.advertise<visualization_msgs::MarkerArray>("fruit_markers", 1, true);
    pre_grasps_ = private_.advertise<geometry_msgs::PoseArray>("pre_grasps", 1, true);
    // Not latched: whoever connects late must not be sent off by an old goal.
    joint_goal_ = private_.advertise<trajectory_msgs::JointTrajectory>("joint_goal", 1);
    status_ = private_.advertise<std_msgs::String>("status", 10, true);

    // One frame is kept: while a view is planned, those that come are old by the time it is done.
    info_in_ = node_.subscribe("depth/camera_info", 1, &ScanNode::take_info, this);
    image_in_ = node_.subscribe("depth/image", 1, &ScanNode::take_image, this);
    points_in_ = node_.subscribe("points", 1, &ScanNode::take_points, this);
    joints_in_ = node_.subscribe("joint_states", 1, &ScanNode::take_joints, this);

    services_ = {
        serve("start", [this] { return session_.start(now()) ? said("started") : refused("a scan is going on"); }),
        serve("stop", [this] { return session_.stop() ? said("stopped") : refused("no scan is going on"); }),
        serve("reset",
              [this] {
                session_.reset();
                return said("reset");
              }),
        serve("skip_view",
              [this] { return session_.refuse(now()) ? said("skipped") : refused("no view was asked for"); })};
    timer_ = node_.createTimer(ros::Duration(0.5), [this](const ros::TimerEvent&) { tick(); });
    publish();
  }

 private:
  struct Own {
    std::string workcell, world_frame = "world", optical_frame;
    bool rectified = false, start = false;
    int seed = 0, threads = 1;
    double speed = 1.0;
  };
  using Answer = std::pair<bool, std::string>;

  static Answer said(const char* text) { return {true, text}; }
  static Answer refused(const char* text) { return {false, text}; }
  static double now() { return ros::Time::now().toSec(); }

  static Own read_own(const ros::NodeHandle& handle) {
    const Ros1Lookup lookup(handle);
    Own own;
    own_fields(own, lookup);
    if (own.workcell.empty())
      throw ParameterError("parameter 'workcell' has to name a scene file (robot, sensor, scan_volume, keep_out)");
    check_parameter(own.speed > 0.0 && own.speed <= 1.0, "speed", "in (0, 1]", own.speed);
    check_parameter(own.threads >= 1, "threads", ">= 1", own.threads);
    check_parameter(own.seed >= 0, "seed", ">= 0", own.seed);
    return own;
  }
  /// f(name, field) for every parameter of the node itself.
  template <typename F>
  static void own_fields(Own& own, F&& f) {
    f("workcell", own.workcell);
    f("world_frame", own.world_frame);
    f("optical_frame", own.optical_frame);
    f("rectified", own.rectified);
    f("autostart", own.start);
    f("seed", own.seed);
    f("threads", own.threads);
    f("speed", own.speed);
  }

  static ScanSession make_session(const ros::NodeHandle& handle, Own own) {
    const Ros1Lookup lookup(handle);
    std::set<std::string> known;
    const Parameters parameters = read_parameters(lookup, "/", known);
    SessionParameters session;
    SessionParameters::fields(session, FieldReader<const Ros1Lookup>(lookup, "arrival/", "/", known));
    own_fields(own, [&](const char* name, auto&) { known.insert(name); });
    lookup.refuse_unknown(known);
    return ScanSession(io::read_scene(own.workcell).workcell, parameters, session, static_cast<std::uint64_t>(own.seed),
                       own.threads);
  }

  template <typename Action>
  ros::ServiceServer serve(const char* name, Action action) {
    return private_.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
        name, [this, action](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
          const Answer answer = action();
          response.success = answer.first;
          response.message = answer.second;
          if (answer.first) publish();
          return true;
        });
  }

  void tick() {
    if (own_.start && joints_heard_ && joint_goal_.getNumSubscribers() > 0) {
      own_.start = false;
      if (session_.start(now())) publish();
    }
    if (!session_.tick(now())) return;
    ROS_WARN("The view was not reached in time, the next best follows");
    publish();
  }

  void take_info(const sensor_msgs::CameraInfoConstPtr& info) { info_ = info; }

  void take_joints(const sensor_msgs::JointStateConstPtr& message) {
    const auto joints = joints_of(*message);
    if (!joints) return;
    guarded([&] { session_.set_joints(*joints, message->header.stamp.toSec()); });
    joints_heard_ = true;
  }

  void take_image(const sensor_msgs::ImageConstPtr& image) {
    if (!info_) return;
    guarded([&] {
      const auto pose = pose_if_arrived(own_.optical_frame.empty() ? image->header.frame_id : own_.optical_frame,
                                        image->header.stamp);
      if (!pose) return;
      session_.observe(interop::depth_frame(*image, *info_, own_.rectified), *pose, now());
      publish();
    });
  }

  void take_points(const sensor_msgs::PointCloud2ConstPtr& message) {
    guarded([&] {
      const std::string& cloud_frame = message->header.frame_id;
      const std::string& frame = own_.optical_frame.empty() ? cloud_frame : own_.optical_frame;
      const auto pose = pose_if_arrived(frame, message->header.stamp);
      if (!pose) return;
      const interop::PointCloud2View view(*message);
      if (frame == cloud_frame) {
        session_.observe_points(view, *pose, now());
      } else {
        const Eigen::Isometry3f optical_T_cloud =
            (pose->inverse() * lookup_pose(cloud_frame, message->header.stamp)).cast<float>();
        std::vector<Eigen::Vector3f> points(view.size());
        for (std::size_t i = 0; i < view.size(); ++i) points[i] = optical_T_cloud * view.point(i);
        session_.observe_points(points, *pose, now());
      }
      publish();
    });
  }

  Pose lookup_pose(const std::string& frame, const ros::Time& stamp) const {
    return pose_of(buffer_.lookupTransform(own_.world_frame, frame, stamp, ros::Duration(0.2)).transform);
  }

  /// world_T_optical at the stamp of a frame where it is the one awaited.
  std::optional<Pose> pose_if_arrived(const std::string& frame, const ros::Time& stamp) const {
    if (session_.state() != SessionState::moving) return std::nullopt;
    const Pose pose = lookup_pose(frame, stamp);
    const Pose before = lookup_pose(frame, stamp - ros::Duration(session_.session_parameters().settle));
    if (!session_.arrived(stamp.toSec(), pose, before)) return std::nullopt;
    return pose;
  }

  /// Bad messages and transforms that are not there are told and left at that.
  template <typename Action>
  static void guarded(Action&& action) {
    try {
      action();
    } catch (const Error& e) {
      ROS_WARN_THROTTLE(1.0, "Left out: %s", e.what());
    } catch (const tf2::TransformException& e) {
      ROS_WARN_THROTTLE(5.0, "Left out, its pose is not known: %s", e.what());
    }
  }

  std_msgs::Header header() const {
    std_msgs::Header h;
    h.stamp = ros::Time::now();
    h.frame_id = own_.world_frame;
    return h;
  }

  geometry_msgs::PoseArray poses_message(const std::vector<Pose>& poses) const {
    return pose_array<geometry_msgs::PoseArray>(header(), poses);
  }

  /// Everything that is known now. The joint goal goes first: the arm moves while the rest is computed; the status
  /// last.
  void publish() {
    publish_goal();
    const Pipeline& pipeline = session_.pipeline();
    publish_views(pipeline);
    publish_result(pipeline.result());
    std_msgs::String status;
    status.data = session_.status();
    status_.publish(status);
    ROS_INFO("%s", status.data.c_str());
  }

  void publish_views(const Pipeline& pipeline) {
    const auto candidates = session_.goal() ? pipeline.candidates() : std::vector<plan::ReachableView>{};
    std::vector<Pose> poses;
    for (const auto& c : candidates) poses.push_back(c.world_T_optical);
    candidates_.publish(poses_message(poses));
    if (session_.goal()) {
      geometry_msgs::PoseStamped chosen;
      chosen.header = header();
      chosen.pose = pose_message<geometry_msgs::Pose>(session_.goal()->world_T_optical);
      chosen_.publish(chosen);
    }
    MarkerMaker<visualization_msgs::MarkerArray> markers(header());
    markers.views(pipeline.views(), candidates, session_.goal(), pipeline.workcell().sensor.intrinsics);
    view_markers_.publish(markers.take());
  }

  void publish_result(const ScanResult& result) {
    sensor_msgs::PointCloud2 cloud;
    cloud.header = header();
    fill_cloud(cloud, result.cloud, result.labels);
    cloud_.publish(cloud);
    const ResultPoses poses = result_poses(result.fruits);
    fruits_.publish(poses_message(poses.fruits));
    bodies_.publish(poses_message(poses.bodies));
    pre_grasps_.publish(poses_message(poses.pre_grasps));
    MarkerMaker<visualization_msgs::MarkerArray> markers(header());
    markers.fruits(result.fruits);
    fruit_markers_.publish(markers.take());
  }

  /// The joints of a new view; nothing at all, by which controllers hold, when a scan was stopped, reset or is done.
  void publish_goal() {
    trajectory_msgs::JointTrajectory goal;
    goal.joint_names.assign(kJointNames.begin(), kJointNames.end());
    if (session_.goal()) {
      if (session_.goals() == goals_published_ || !session_.goal()->joints) return;
      goals_published_ = session_.goals();
      goal.points.resize(1);
      goal.points[0].positions.assign(session_.goal()->joints->data(), session_.goal()->joints->data() + 6);
      goal.points[0].time_from_start = ros::Duration(std::max(session_.goal()->move_time, 0.1) / own_.speed);
    }
    joint_goal_.publish(goal);
  }

  ros::NodeHandle node_, private_;
  Own own_;
  ScanSession session_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  sensor_msgs::CameraInfoConstPtr info_;
  bool joints_heard_ = false;
  std::size_t goals_published_ = 0;
  ros::Publisher cloud_, candidates_, chosen_, view_markers_, fruits_, bodies_, fruit_markers_, pre_grasps_,
      joint_goal_, status_;
  ros::Subscriber info_in_, image_in_, points_in_, joints_in_;
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
