// SPDX-License-Identifier: BSD-3-Clause
// agrisee's whole pipeline as one ROS 2 node (written for Humble and later): ../ros1/scan_node.cpp with the other
// generation's names around the same logic. NOT COMPILED SO FAR: where this was written there is no ROS 2.
#include <agrisee/io/scene.hpp>

#include <geometry_msgs/msg/pose_array.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <rclcpp/rclcpp.hpp>
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

#include "joint_names.hpp"
#include "messages.hpp"
#include "read_parameters.hpp"
#include "scan_session.hpp"

namespace agrisee::robot {

/// Declares a parameter with a field's value as its default and takes what was set for it.
class Ros2Lookup {
 public:
  explicit Ros2Lookup(rclcpp::Node& node) : node_(node) {}
  template <typename T>
  void operator()(const std::string& name, T& field) {
    using Stored = std::conditional_t<std::is_same_v<T, bool> || std::is_same_v<T, std::string>, T,
                                      std::conditional_t<std::is_integral_v<T>, std::int64_t, double>>;
    try {
      if (!node_.has_parameter(name)) node_.declare_parameter<Stored>(name, static_cast<Stored>(field));
      field = static_cast<T>(node_.get_parameter(name).get_value<Stored>());
    } catch (const rclcpp::exceptions::InvalidParameterTypeException& e) {
      throw ParameterError(e.what());
    }
  }
  /// @throws ParameterError naming a parameter that was set but is not among the `known` ones
  void refuse_unknown(const std::set<std::string>& known) const {
    for (const auto& entry : node_.get_node_parameters_interface()->get_parameter_overrides())
      if (!known.count(entry.first) && entry.first != "use_sim_time" && entry.first.rfind("qos_overrides.", 0) != 0)
        throw ParameterError("unknown parameter '" + entry.first + "'");
  }

 private:
  rclcpp::Node& node_;
};

class ScanNode : public rclcpp::Node {
 public:
  ScanNode() : Node("agrisee"), session_(make_session()), buffer_(get_clock()), listener_(buffer_) {
    const auto latched = rclcpp::QoS(1).transient_local();
    cloud_ = create_publisher<sensor_msgs::msg::PointCloud2>("~/cloud", latched);
    candidates_ = create_publisher<PoseArray>("~/candidate_views", latched);
    chosen_ = create_publisher<geometry_msgs::msg::PoseStamped>("~/chosen_view", latched);
    view_markers_ = create_publisher<Markers>("~/view_markers", latched);
    fruits_ = create_publisher<PoseArray>("~/fruits", latched);
    bodies_ = create_publisher<PoseArray>("~/bodies", latched);
    fruit_markers_ = create_publisher<Markers>("~/fruit_markers", latched);
    pre_grasps_ = create_publisher<PoseArray>("~/pre_grasps", latched);
    joint_goal_ = create_publisher<Trajectory>("~/joint_goal", 1);  // not latched: an old goal must not move anybody
    status_ = create_publisher<std_msgs::msg::String>("~/status", latched);

    const auto sensor = rclcpp::SensorDataQoS().keep_last(1);
    subscriptions_ = {
        create_subscription<CameraInfo>("depth/camera_info", sensor,
                                        [this](CameraInfo::ConstSharedPtr m) { info_ = m; }),
        create_subscription<Image>("depth/image", sensor, [this](Image::ConstSharedPtr m) { take_image(*m); }),
        create_subscription<Cloud2>("points", sensor, [this](Cloud2::ConstSharedPtr m) { take_points(*m); }),
        create_subscription<JointState>("joint_states", 1, [this](JointState::ConstSharedPtr m) {
          const auto joints = joints_of(*m);
          if (!joints) return;
          guarded([&] { session_->set_joints(*joints, rclcpp::Time(m->header.stamp).seconds()); });
          joints_heard_ = true;
        })};
    services_ = {serve("~/start", "a scan is going on", [this] { return session_->start(seconds()); }),
                 serve("~/stop", "no scan is going on", [this] { return session_->stop(); }),
                 serve("~/reset", "",
                       [this] {
                         session_->reset();
                         return true;
                       }),
                 serve("~/skip_view", "no view was asked for", [this] { return session_->refuse(seconds()); })};
    timer_ = create_wall_timer(std::chrono::milliseconds(500), [this] { tick(); });
    publish();
  }

 private:
  using PoseArray = geometry_msgs::msg::PoseArray;
  using Markers = visualization_msgs::msg::MarkerArray;
  using Trajectory = trajectory_msgs::msg::JointTrajectory;
  using CameraInfo = sensor_msgs::msg::CameraInfo;
  using Image = sensor_msgs::msg::Image;
  using Cloud2 = sensor_msgs::msg::PointCloud2;
  using JointState = sensor_msgs::msg::JointState;
  using Trigger = std_srvs::srv::Trigger;

  std::unique_ptr<ScanSession> make_session() {
    Ros2Lookup lookup(*this);
    std::set<std::string> known;
    const auto own = [&](const char* name, auto& field) {
      lookup(name, field);
      known.insert(name);
    };
    std::string workcell;
    int seed = 0, threads = 1;
    own("workcell", workcell);
    own("world_frame", world_frame_);
    own("optical_frame", optical_frame_);
    own("rectified", rectified_);
    own("autostart", autostart_);
    own("seed", seed);
    own("threads", threads);
    own("speed", speed_);
    if (workcell.empty()) throw ParameterError("parameter 'workcell' has to name a scene file");
    check_parameter(speed_ > 0.0 && speed_ <= 1.0, "speed", "in (0, 1]", speed_);
    check_parameter(threads >= 1, "threads", ">= 1", threads);
    check_parameter(seed >= 0, "seed", ">= 0", seed);
    const Parameters parameters = read_parameters(lookup, ".", known);
    SessionParameters session;
    SessionParameters::fields(session, FieldReader<Ros2Lookup>(lookup, "arrival.", ".", known));
    lookup.refuse_unknown(known);
    return std::make_unique<ScanSession>(io::read_scene(workcell).workcell, parameters, session,
                                         static_cast<std::uint64_t>(seed), threads);
  }

  void tick() {
    if (autostart_ && joints_heard_ && joint_goal_->get_subscription_count() > 0) {
      autostart_ = false;
      if (session_->start(seconds())) publish();
    }
    if (!session_->tick(seconds())) return;
    RCLCPP_WARN(get_logger(), "The view was not reached in time, the next best follows");
    publish();
  }

  template <typename Action>
  rclcpp::ServiceBase::SharedPtr serve(const char* name, const char* refusal, Action action) {
    return create_service<Trigger>(name, [this, refusal, action](const std::shared_ptr<Trigger::Request>,
                                                                 std::shared_ptr<Trigger::Response> response) {
      response->success = action();
      response->message = response->success ? session_->status() : refusal;
      if (response->success) publish();
    });
  }

  double seconds() const { return now().seconds(); }

  void take_image(const Image& image) {
    if (!info_) return;
    guarded([&] {
      const auto pose =
          pose_if_arrived(optical_frame_.empty() ? image.header.frame_id : optical_frame_, image.header.stamp);
      if (!pose) return;
      session_->observe(interop::depth_frame(image, *info_, rectified_), *pose, seconds());
      publish();
    });
  }

  void take_points(const Cloud2& message) {
    guarded([&] {
      const std::string& cloud_frame = message.header.frame_id;
      const std::string& frame = optical_frame_.empty() ? cloud_frame : optical_frame_;
      const auto pose = pose_if_arrived(frame, message.header.stamp);
      if (!pose) return;
      const interop::PointCloud2View view(message);
      const Eigen::Isometry3f optical_T_cloud =
          frame == cloud_frame
              ? Eigen::Isometry3f::Identity()
              : Eigen::Isometry3f((pose->inverse() * lookup_pose(cloud_frame, message.header.stamp)).cast<float>());
      std::vector<Eigen::Vector3f> points(view.size());
      for (std::size_t i = 0; i < view.size(); ++i) points[i] = optical_T_cloud * view.point(i);
      session_->observe_points(points, *pose, seconds());
      publish();
    });
  }

  Pose lookup_pose(const std::string& frame, const rclcpp::Time& stamp) const {
    const tf2::TimePoint time{std::chrono::nanoseconds(stamp.nanoseconds())};
    return pose_of(buffer_.lookupTransform(world_frame_, frame, time, tf2::durationFromSec(0.2)).transform);
  }

  std::optional<Pose> pose_if_arrived(const std::string& frame, const rclcpp::Time& stamp) const {
    if (session_->state() != SessionState::moving) return std::nullopt;
    const Pose pose = lookup_pose(frame, stamp);
    const double settle = session_->session_parameters().settle;
    const Pose before = lookup_pose(frame, stamp - rclcpp::Duration::from_seconds(settle));
    if (!session_->arrived(stamp.seconds(), pose, before)) return std::nullopt;
    return pose;
  }

  template <typename Action>
  void guarded(Action&& action) {
    try {
      action();
    } catch (const Error& e) {
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 1000, "Left out: %s", e.what());
    } catch (const tf2::TransformException& e) {
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 5000, "Left out, its pose is not known: %s", e.what());
    }
  }

  std_msgs::msg::Header header() const {
    std_msgs::msg::Header h;
    h.stamp = now();
    h.frame_id = world_frame_;
    return h;
  }

  void publish() {
    publish_goal();
    const Pipeline& pipeline = session_->pipeline();
    const auto candidates = session_->goal() ? pipeline.candidates() : std::vector<plan::ReachableView>{};
    std::vector<Pose> poses;
    for (const auto& c : candidates) poses.push_back(c.world_T_optical);
    candidates_->publish(pose_array<PoseArray>(header(), poses));
    if (session_->goal()) {
      geometry_msgs::msg::PoseStamped chosen;
      chosen.header = header();
      chosen.pose = pose_message<geometry_msgs::msg::Pose>(session_->goal()->world_T_optical);
      chosen_->publish(chosen);
    }
    MarkerMaker<Markers> views(header());
    views.views(pipeline.views(), candidates, session_->goal(), pipeline.workcell().sensor.intrinsics);
    view_markers_->publish(views.take());

    const ScanResult result = pipeline.result();
    Cloud2 cloud;
    cloud.header = header();
    fill_cloud(cloud, result.cloud, result.labels);
    cloud_->publish(cloud);
    const ResultPoses found = result_poses(result.fruits);
    fruits_->publish(pose_array<PoseArray>(header(), found.fruits));
    bodies_->publish(pose_array<PoseArray>(header(), found.bodies));
    pre_grasps_->publish(pose_array<PoseArray>(header(), found.pre_grasps));
    MarkerMaker<Markers> fruit(header());
    fruit.fruits(result.fruits);
    fruit_markers_->publish(fruit.take());
    std_msgs::msg::String status;
    status.data = session_->status();
    status_->publish(status);
    RCLCPP_INFO(get_logger(), "%s", status.data.c_str());
  }

  void publish_goal() {
    Trajectory goal;
    goal.joint_names.assign(kJointNames.begin(), kJointNames.end());
    if (session_->goal()) {
      if (session_->goals() == goals_published_ || !session_->goal()->joints) return;
      goals_published_ = session_->goals();
      goal.points.resize(1);
      goal.points[0].positions.assign(session_->goal()->joints->data(), session_->goal()->joints->data() + 6);
      goal.points[0].time_from_start =
          rclcpp::Duration::from_seconds(std::max(session_->goal()->move_time, 0.1) / speed_);
    }
    joint_goal_->publish(goal);
  }

  std::string world_frame_ = "world", optical_frame_;
  bool rectified_ = false, autostart_ = false;
  double speed_ = 1.0;
  std::unique_ptr<ScanSession> session_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  CameraInfo::ConstSharedPtr info_;
  bool joints_heard_ = false;
  std::size_t goals_published_ = 0;
  rclcpp::Publisher<Cloud2>::SharedPtr cloud_;
  rclcpp::Publisher<PoseArray>::SharedPtr candidates_, fruits_, bodies_, pre_grasps_;
  rclcpp::Publisher<geometry_msgs::msg::PoseStamped>::SharedPtr chosen_;
  rclcpp::Publisher<Markers>::SharedPtr view_markers_, fruit_markers_;
  rclcpp::Publisher<Trajectory>::SharedPtr joint_goal_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr status_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace agrisee::robot

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  int code = 0;
  try {
    rclcpp::spin(std::make_shared<agrisee::robot::ScanNode>());
  } catch (const agrisee::Error& e) {
    RCLCPP_FATAL(rclcpp::get_logger("agrisee"), "%s", e.what());
    code = 1;
  }
  rclcpp::shutdown();
  return code;
}
