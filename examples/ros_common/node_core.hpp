// SPDX-License-Identifier: BSD-3-Clause
// What a scan node does with its messages, for both generations of ROS: a class `Ros` hands in their names.
#pragma once

#include <agrisee/io/scene.hpp>

#include "node_outputs.hpp"

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
///   std::uint32_t nanoseconds(stamp)      those beyond the stamp's whole seconds
///   Duration duration(seconds)            as messages have it
///   Pose world_T(frame, stamp, earlier)   the pose of a frame in `world_frame`, `earlier` seconds before a stamp;
///                                         throws PoseUnknown
///   void publish(topic, message)          under one of the names that NodeOutputs lists
///   std::size_t listeners(topic)          how many subscribers a topic has
///   bool kEmptyHolds                      whether every trajectory controller holds when it gets one without points
///   waiting_joints()                      the newest joint states that came and were not handed over yet, for an arm
///                                         that is told to hold; false in a condition if there are none
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
        matcher_(own_.channels),
        outputs_(ros, setup) {}

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
    warn_of_joints();
    guarded([&] {
      if (own_.autostart && joints_heard_ && ros_.listeners("joint_goal") > 0) {
        own_.autostart = false;
        start();
      }
      if (!session_.tick(ros_.now())) return;
      std::string next = "there is no other";
      if (session_.state() == SessionState::moving) next = "the next best follows";
      if (session_.state() == SessionState::paused)
        next = std::to_string(ScanSession::kMostMissed) + " in a row: the scan stops, start goes on with this view";
      ros_.warn("The view was not taken in time: " + session_.missed_for() + "; " + next);
      publish();
    });
  }

  void take_info(const CameraInfoPtr& info) { info_ = info; }

  void take_joints(const typename Ros::JointState& message) {
    const auto joints = joints_of(message, own_.joint_prefix);
    if (!joints) {
      other_joints_ = message.name;
      return;
    }
    guarded([&] {
      session_.set_joints(*joints, ros_.seconds(message.header.stamp));
      joints_heard_ = true;
    });
  }

  void take_image(const ImagePtr& image) {
    if (!info_) return session_.note("depth images came, but no camera info", ros_.now());
    guarded([&] {
      const auto& header = image->header;
      const auto pose =
          pose_if_arrived(own_.optical_frame.empty() ? header.frame_id : own_.optical_frame, header.stamp);
      if (!pose) return;
      matcher_.add_depth(ros_.seconds(header.stamp), {image, info_, *pose});
      session_.note("the depth image's colors or labels did not come", ros_.now());
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

  /// Everything that is known now.
  void publish() {
    matcher_.forget_depths();  // they were of the last view
    // While a view was planned, none were taken: those that are known are of an arm that has moved since.
    if (const auto joints = ros_.waiting_joints()) take_joints(*joints);
    outputs_.publish(session_);
  }

  const NodeParameters& parameters() const { return own_; }
  const ScanSession& session() const { return session_; }

 private:
  struct Depth {
    ImagePtr image;
    CameraInfoPtr info;
    Pose world_T_optical;
  };

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

  /// Once, if joint states come, but never the arm's. Those of a gripper may come first.
  void warn_of_joints() {
    if (joints_heard_ || warned_of_joints_ || other_joints_.empty()) return;
    warned_of_joints_ = true;
    std::string text = "joint_states do not name all of";
    for (const std::string& name : joint_names(own_.joint_prefix)) text += " " + name;
    text += "; they name";
    for (const std::string& name : other_joints_) text += " " + name;
    ros_.warn(text + ". Is joint_prefix right? Until they come, the last goal counts as reached");
  }

  /// world_T_optical at the stamp of a frame where it is the one awaited; else why not is noted.
  template <typename Stamp>
  std::optional<Pose> pose_if_arrived(const std::string& frame, const Stamp& stamp) {
    if (session_.state() != SessionState::moving) return std::nullopt;
    const double taken = ros_.seconds(stamp);
    std::string objection = "the frame has no usable stamp";
    try {
      if (taken >= own_.arrival.settle) {
        const Pose pose = ros_.world_T(frame, stamp, 0.0);
        objection = session_.objection(taken, pose, ros_.world_T(frame, stamp, own_.arrival.settle));
        if (objection.empty()) return pose;
      }
    } catch (const PoseUnknown& e) {
      throw PoseUnknown(e.what() + hints(taken));
    }
    session_.note(objection + hints(taken), ros_.now());
    return std::nullopt;
  }

  /// What may be behind a frame, taken at `taken` (s), that is not the one awaited.
  std::string hints(double taken) const {
    constexpr double kLate = 5.0;  // no planning takes that long (s)
    const double behind = ros_.now() - taken;
    std::string text;
    if (std::abs(behind) > kLate)
      text += "; its stamp is " + number_text(std::abs(behind), 3) + " s " + (behind > 0.0 ? "behind" : "ahead of") +
              " the node's clock: sensor and node must share one";
    if (ros_.listeners("joint_goal") + ros_.listeners("chosen_view") == 0)
      text += "; nobody listens to joint_goal or chosen_view";
    return text;
  }

  /// Runs an action; a bad message or an unknown pose is reported, noted and skipped.
  template <typename Action>
  void guarded(Action&& action) {
    try {
      action();
    } catch (const Error& e) {
      session_.note(e.what(), ros_.now());
      ros_.left_out(std::string("Left out: ") + e.what());
    }
  }

  Ros& ros_;
  NodeParameters own_;
  ScanSession session_;
  FrameMatcher<Depth, ImagePtr> matcher_;
  CameraInfoPtr info_;
  bool joints_heard_ = false, warned_of_joints_ = false;
  std::vector<std::string> other_joints_;  // names in joint states without the arm's
  NodeOutputs<Ros> outputs_;
};

}  // namespace agrisee::robot
