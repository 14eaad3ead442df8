// SPDX-License-Identifier: BSD-3-Clause
// What a scan node does with its messages, for both generations of ROS: a class `Ros` hands in their names.
#pragma once

#include <agrisee/io/scene.hpp>

#include "joint_names.hpp"
#include "messages.hpp"
#include "node_parameters.hpp"

namespace agrisee::robot {

/// tf cannot tell where a frame was.
struct PoseUnknown : Error {
  using Error::Error;
};

/// The answer to a service.
struct Answer {
  bool success;
  std::string message;
};

/// A scan node but for its connections: takes messages and calls, asks for views and publishes what is found. Not to be
/// called by two threads at once.
///
/// Ros names the types `Image`, `CameraInfo`, `PointCloud2`, `JointState`, `PoseArray`, `PoseStamped`, `MarkerArray`,
/// `JointTrajectory`, `String` and the pointers to const `ImagePtr` and `CameraInfoPtr`, and has the members
///   double now()                          time of the sensor's clock (s)
///   Stamp stamp()                         the same as messages have it
///   double seconds(stamp)                 a message's stamp (s)
///   Duration duration(seconds)            as messages have it
///   Pose world_T(frame, stamp, earlier)   the pose of a frame in `world_frame`, `earlier` seconds before a stamp;
///                                         throws PoseUnknown
///   void publish(topic, message)          under one of the names that outputs() lists
///   std::size_t listeners(topic)          how many subscribers a topic has
///   void info(text), void warn(text)      a line for people
///   void left_out(text)                   the same for a message that is not used, at most once a second
template <typename Ros>
class NodeCore {
 public:
  using Image = typename Ros::Image;
  using ImagePtr = typename Ros::ImagePtr;
  using CameraInfoPtr = typename Ros::CameraInfoPtr;

  /// @throws Error for an unusable workcell or parameter
  NodeCore(Ros& ros, const NodeSetup& setup)
      : ros_(ros),
        own_(setup.node),
        session_(io::read_scene(own_.workcell).workcell, setup.pipeline, own_.arrival,
                 static_cast<std::uint64_t>(own_.seed), own_.threads),
        matcher_(own_.channels) {}

  /// f(topic, message, latched) for everything that is published; the message only tells its type. Joint goals are not
  /// latched: whoever connects late must not be sent off by an old one.
  template <typename F>
  static void outputs(F&& f) {
    f("joint_goal", typename Ros::JointTrajectory(), false);
    f("chosen_view", typename Ros::PoseStamped(), true);
    f("candidate_views", typename Ros::PoseArray(), true);
    f("view_markers", typename Ros::MarkerArray(), true);
    f("cloud", typename Ros::PointCloud2(), true);
    f("fruits", typename Ros::PoseArray(), true);
    f("bodies", typename Ros::PoseArray(), true);
    f("fruit_markers", typename Ros::MarkerArray(), true);
    f("pre_grasps", typename Ros::PoseArray(), true);
    f("status", typename Ros::String(), true);
  }

  /// f(name, call) for every service; serve(call) does what the service is for.
  template <typename F>
  static void services(F&& f) {
    f("start", [](NodeCore& core) { return core.start(); });
    f("stop", [](NodeCore& core) { return core.stop(); });
    f("reset", [](NodeCore& core) { return core.reset(); });
    f("skip_view", [](NodeCore& core) { return core.skip_view(); });
  }

  Answer start() { return answer(session_.start(ros_.now()), "started", "a scan is going on"); }
  Answer stop() { return answer(session_.stop(), "stopped", "no scan is going on"); }
  Answer reset() {
    session_.reset();
    return answer(true, "reset", "");
  }
  Answer skip_view() { return answer(session_.refuse(ros_.now()), "skipped", "no view was asked for"); }

  /// What a service answers; an Error, as of joints that the arm cannot have, is a refusal.
  template <typename Call>
  Answer serve(const Call& call) {
    try {
      return call(*this);
    } catch (const Error& e) {
      return {false, e.what()};
    }
  }

  /// To be called twice a second or so.
  void tick() {
    guarded([&] {
      if (own_.autostart && joints_heard_ && ros_.listeners("joint_goal") > 0) {
        own_.autostart = false;
        start();
      }
      if (!session_.tick(ros_.now())) return;
      ros_.warn("The view was not reached in time, the next best follows");
      publish();
    });
  }

  void take_info(const CameraInfoPtr& info) { info_ = info; }

  void take_joints(const typename Ros::JointState& message) {
    const auto joints = joints_of(message);
    if (!joints) return;
    guarded([&] {
      session_.set_joints(*joints, ros_.seconds(message.header.stamp));
      joints_heard_ = true;
    });
  }

  void take_image(const ImagePtr& image) {
    if (!info_) return;
    guarded([&] {
      const auto& header = image->header;
      const auto pose =
          pose_if_arrived(own_.optical_frame.empty() ? header.frame_id : own_.optical_frame, header.stamp);
      if (!pose) return;
      matcher_.add_depth(ros_.seconds(header.stamp), {image, info_, *pose});
      observe_match();
    });
  }
  void take_color(const ImagePtr& image) {
    matcher_.add_color(ros_.seconds(image->header.stamp), image);
    guarded([&] { observe_match(); });
  }
  void take_labels(const ImagePtr& image) {
    matcher_.add_labels(ros_.seconds(image->header.stamp), image);
    guarded([&] { observe_match(); });
  }

  void take_points(const typename Ros::PointCloud2& message) {
    guarded([&] {
      const std::string& cloud_frame = message.header.frame_id;
      const std::string& frame = own_.optical_frame.empty() ? cloud_frame : own_.optical_frame;
      const auto pose = pose_if_arrived(frame, message.header.stamp);
      if (!pose) return;
      const interop::PointCloud2View<typename Ros::PointCloud2> view(message);
      if (frame == cloud_frame) {
        session_.observe_points(view, *pose, ros_.now());
      } else {
        const Eigen::Isometry3f optical_T_cloud =
            (pose->inverse() * ros_.world_T(cloud_frame, message.header.stamp, 0.0)).template cast<float>();
        std::vector<Eigen::Vector3f> points(view.size());
        for (std::size_t i = 0; i < view.size(); ++i) points[i] = optical_T_cloud * view.point(i);
        session_.observe_points(points, *pose, ros_.now());
      }
      publish();
    });
  }

  /// Everything that is known now. The joint goal goes first: the arm moves while the rest is computed; the status
  /// last.
  void publish() {
    matcher_.forget_depths();  // they were of the last view
    publish_goal();
    publish_views();
    publish_result(session_.pipeline().result());
    typename Ros::String status;
    status.data = session_.status();
    ros_.publish("status", status);
    ros_.info(status.data);
  }

  const NodeParameters& parameters() const { return own_; }
  const ScanSession& session() const { return session_; }

 private:
  struct Depth {
    ImagePtr image;
    CameraInfoPtr info;
    Pose world_T_optical;
  };
  using Header = decltype(Ros::PoseStamped::header);

  Answer answer(bool done, const char* success, const char* refusal) {
    if (done) publish();
    return {done, done ? success : refusal};
  }

  void observe_match() {
    const auto match = matcher_.take();
    if (!match) return;
    if (!match->complete) ros_.left_out("colors or labels did not come in time; the frame goes without");
    const interop::Channels<Image> channels{match->color.get(), match->labels.get(), own_.channels.score};
    const Depth& depth = match->depth;
    session_.observe(interop::depth_frame(*depth.image, *depth.info, own_.rectified, channels), depth.world_T_optical,
                     ros_.now());
    publish();
  }

  /// world_T_optical at the stamp of a frame where it is the one awaited.
  template <typename Stamp>
  std::optional<Pose> pose_if_arrived(const std::string& frame, const Stamp& stamp) const {
    if (session_.state() != SessionState::moving || ros_.seconds(stamp) < own_.arrival.settle) return std::nullopt;
    const Pose pose = ros_.world_T(frame, stamp, 0.0);
    const Pose before = ros_.world_T(frame, stamp, own_.arrival.settle);
    if (!session_.arrived(ros_.seconds(stamp), pose, before)) return std::nullopt;
    return pose;
  }

  /// Runs an action; a bad message or an unknown pose is reported and skipped.
  template <typename Action>
  void guarded(Action&& action) {
    try {
      action();
    } catch (const Error& e) {
      ros_.left_out(std::string("Left out: ") + e.what());
    }
  }

  Header header() const {
    Header h;
    h.stamp = ros_.stamp();
    h.frame_id = own_.world_frame;
    return h;
  }

  void publish_poses(const char* topic, const std::vector<Pose>& poses) {
    ros_.publish(topic, pose_array<typename Ros::PoseArray>(header(), poses));
  }

  void publish_views() {
    const Pipeline& pipeline = session_.pipeline();
    const auto candidates = session_.goal() ? pipeline.candidates() : std::vector<plan::ReachableView>{};
    std::vector<Pose> poses;
    for (const auto& c : candidates) poses.push_back(c.world_T_optical);
    publish_poses("candidate_views", poses);
    if (session_.goal()) {
      typename Ros::PoseStamped chosen;
      chosen.header = header();
      chosen.pose = pose_message<decltype(chosen.pose)>(session_.goal()->world_T_optical);
      ros_.publish("chosen_view", chosen);
    }
    MarkerMaker<typename Ros::MarkerArray> markers(header());
    markers.views(pipeline.views(), candidates, session_.goal(), pipeline.workcell().sensor.intrinsics);
    ros_.publish("view_markers", markers.take());
  }

  void publish_result(const ScanResult& result) {
    typename Ros::PointCloud2 cloud;
    cloud.header = header();
    fill_cloud(cloud, result.cloud, result.labels);
    ros_.publish("cloud", cloud);
    const ResultPoses poses = result_poses(result.fruits);
    publish_poses("fruits", poses.fruits);
    publish_poses("bodies", poses.bodies);
    publish_poses("pre_grasps", poses.pre_grasps);
    MarkerMaker<typename Ros::MarkerArray> markers(header());
    markers.fruits(result.fruits);
    ros_.publish("fruit_markers", markers.take());
  }

  /// The joints of a new view; nothing at all, by which controllers hold, when a scan was stopped, reset or is done.
  void publish_goal() {
    typename Ros::JointTrajectory goal;
    goal.joint_names.assign(kJointNames.begin(), kJointNames.end());
    if (const auto& view = session_.goal()) {
      if (session_.goals() == goals_published_ || !view->joints) return;
      goals_published_ = session_.goals();
      goal.points.resize(1);
      goal.points[0].positions.assign(view->joints->data(), view->joints->data() + 6);
      goal.points[0].time_from_start = ros_.duration(std::max(view->move_time, 0.1) / own_.speed);
    }
    ros_.publish("joint_goal", goal);
  }

  Ros& ros_;
  NodeParameters own_;
  ScanSession session_;
  FrameMatcher<Depth, ImagePtr> matcher_;
  CameraInfoPtr info_;
  bool joints_heard_ = false;
  std::size_t goals_published_ = 0;
};

}  // namespace agrisee::robot
