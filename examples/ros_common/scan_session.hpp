// SPDX-License-Identifier: BSD-3-Clause
// What a robot node decides, without ROS: when to ask for the next view, whether the arm has arrived and stands still,
// which frame to take, what to do when a move fails. Times are seconds of the sensor's clock, poses are in world.
#pragma once

#include <agrisee/core/parameter_range.hpp>
#include <agrisee/geometry/angle.hpp>
#include <agrisee/pipeline.hpp>

namespace agrisee::robot {

/// When a frame counts as taken from the view that was asked for.
struct SessionParameters {
  double position_tolerance = 0.02;  ///< largest distance between the sensor and the view (m)
  double angle_tolerance = 0.05;     ///< largest angle between the sensor's orientation and the view's (rad)
  double settle = 0.3;               ///< how long the sensor has to stand still before a frame is taken (s)
  double still_distance = 0.0005;    ///< it stands still if it moves by no more than this in that time (m)
  double still_angle = 0.002;        ///< and turns by no more than this (rad)
  double move_timeout = 60.0;        ///< a view that is not reached in this time is given up for the next best (s)

  /// @throws FieldError for the first field that is out of its range, e.g. `arrival.settle`
  void check() const { check_fields(*this, "arrival."); }

  /// f(name, field, range) for every field.
  template <typename P, typename F>
  static void fields(P& p, F&& f) {
    f("position_tolerance", p.position_tolerance, Range::positive());
    f("angle_tolerance", p.angle_tolerance, Range::positive());
    f("settle", p.settle, Range::positive());
    f("still_distance", p.still_distance, Range::positive());
    f("still_angle", p.still_angle, Range::positive());
    f("move_timeout", p.move_timeout, Range::positive());
  }
};

/// Where a session is.
enum class SessionState {
  idle,    ///< not started, or reset
  moving,  ///< the arm is on its way to goal(), or stands there and a frame is awaited
  paused,  ///< stopped by the caller; start() goes on
  done     ///< there is no further view; stop_reason() says why
};

inline const char* to_string(SessionState state) {
  switch (state) {
    case SessionState::idle:
      return "idle";
    case SessionState::moving:
      return "moving";
    case SessionState::paused:
      return "paused";
    case SessionState::done:
      return "done";
  }
  return "unknown";
}

/// One scan after another of one workcell, driven by start, stop, reset, time and frames.
class ScanSession {
 public:
  /// After so many views in a row that time ran out for, the scan stops: arm or camera must have failed.
  static constexpr int kMostMissed = 3;

  /// @throws ParameterError, InputError for an unusable workcell
  ScanSession(const Workcell& workcell, const Parameters& parameters, const SessionParameters& session = {},
              std::uint64_t seed = 0, int threads = 1)
      : workcell_(workcell), parameters_(parameters), session_(session), seed_(seed), threads_(threads) {
    session_.check();
    begin();
  }

  /// Begin a scan, or go on with one that was stopped. A scan that is done is followed by a new one.
  /// @return false when one is going on already, which is left alone
  bool start(double now) {
    if (state_ == SessionState::moving) return false;
    if (state_ == SessionState::done) begin();
    forget_misses();
    choose(now);
    return true;
  }

  /// Take no further frame; what was seen so far is kept.
  /// @return false when no scan is going on
  bool stop() {
    if (state_ != SessionState::moving) return false;
    goal_.reset();
    state_ = SessionState::paused;
    return true;
  }

  /// Forget what was seen.
  void reset() { begin(); }

  /// The arm cannot take the view: the next best follows. @return false when no view was asked for
  bool refuse(double now) {
    if (state_ != SessionState::moving) return false;
    ++refused_;
    missed_for_.clear();
    pipeline_->refused();
    choose(now);
    return true;
  }

  /// To be called now and then: a view that is not reached in time is given up for the next best; the last of
  /// kMostMissed in a row stops the scan instead, and is asked for again by start(). @return true when one was given up
  bool tick(double now) {
    if (state_ != SessionState::moving || now - asked_at_ <= session_.move_timeout) return false;
    const std::string cause = cause_at(now);
    if (missed_ + 1 < kMostMissed) {
      refuse(now);
      ++missed_;
    } else {
      ++refused_;
      stop();
    }
    missed_for_ = cause;
    return true;
  }

  /// Tell why the awaited frame could not be taken yet; when its view is given up, the last cause is told.
  void note(const std::string& cause, double now) {
    if (state_ != SessionState::moving) return;
    cause_ = cause;
    cause_at_ = now;
  }

  /// Where the arm stood at `stamp` (rad); without it the planner reckons from the last goal.
  void set_joints(const Joints& joints, double stamp) {
    check_input(joints.allFinite(), "a joint angle is not finite");
    joints_ = joints;
    joints_stamp_ = stamp;
  }

  /// Why a frame stamped `stamp`, when the sensor was at `world_T_optical`, and at `before` `settle` seconds earlier,
  /// is not the one awaited; empty if it is. If joint states are received, one from before the standstill is not
  /// enough: the next view is planned from it.
  std::string objection(double stamp, const Pose& world_T_optical, const Pose& before) const {
    if (state_ != SessionState::moving) return "no view was asked for";
    const double standing_since = stamp - session_.settle;
    if (standing_since < asked_at_) return "the frame is from before the arm could have stood at the view";
    const Distance off(world_T_optical, goal_->world_T_optical);
    if (!off.within(session_.position_tolerance, session_.angle_tolerance))
      return "the sensor is " + off.text() + " from the view, " +
             Distance(session_.position_tolerance, session_.angle_tolerance).text() + " are allowed";
    const Distance moved(world_T_optical, before);
    if (!moved.within(session_.still_distance, session_.still_angle))
      return "the sensor does not stand still: it moved by " + moved.text() + " in " + number_text(session_.settle, 3) +
             " s";
    if (joints_stamp_ && *joints_stamp_ < standing_since)
      return "the last joint states are " + number_text(stamp - *joints_stamp_, 3) + " s older than the frame";
    return "";
  }

  /// Take in the frame of the view that was asked for, and choose the next.
  /// @throws InputError for an unusable frame or pose; the session stays where it is then, and another may follow
  void observe(const sensor::DepthFrame& frame, const Pose& world_T_optical, double now) {
    check_input(state_ == SessionState::moving, "a frame that nobody asked for");
    if (!joints_stamp_ && goal_->joints) joints_ = *goal_->joints;
    pipeline_->observe(frame, world_T_optical, joints_);
    forget_misses();
    choose(now);
  }
  /// The same for points in the optical frame, any cloud type.
  template <typename C>
  void observe_points(const C& points, const Pose& world_T_optical, double now) {
    observe(sensor::frame_from_points(points, workcell_.sensor.intrinsics), world_T_optical, now);
  }

  SessionState state() const { return state_; }
  const SessionParameters& session_parameters() const { return session_; }
  /// The view to move to; empty unless moving. With every new one `goals()` grows.
  const std::optional<plan::ReachableView>& goal() const { return goal_; }
  std::size_t goals() const { return goals_; }
  /// Which scan this is, from 1; start() after the end and reset() begin another.
  std::size_t scans() const { return scans_; }
  int refused() const { return refused_; }
  /// How many views in a row were given up because time ran out, and why the last of them could not be taken.
  int missed() const { return missed_; }
  const std::string& missed_for() const { return missed_for_; }
  /// Where the arm stood last (rad), and when; without a stamp nobody told, and it is the last view's or the
  /// workcell's.
  const Joints& joints() const { return joints_; }
  const std::optional<double>& joints_stamp() const { return joints_stamp_; }
  const Pipeline& pipeline() const { return *pipeline_; }

  /// One line for people.
  std::string status() const {
    std::string text = std::string(to_string(state_)) + ", " + std::to_string(pipeline_->views().size()) + " views";
    if (refused_ > 0) text += ", " + std::to_string(refused_) + " refused";
    if (!missed_for_.empty()) text += " (" + missed_for_ + ")";
    if (state_ == SessionState::done) text += std::string(", ") + agrisee::to_string(pipeline_->stop_reason());
    return text;
  }

 private:
  /// How far a pose is from another.
  struct Distance {
    double length, angle;  // m, rad
    Distance(double metres, double radians) : length(metres), angle(radians) {}
    Distance(const Pose& a, const Pose& b)
        : length((a.translation() - b.translation()).norm()), angle(turn_between(a, b)) {}
    bool within(double most_length, double most_angle) const { return length <= most_length && angle <= most_angle; }
    std::string text() const { return number_text(1e3 * length, 3) + " mm and " + number_text(angle, 3) + " rad"; }
  };

  /// Why the awaited frame has not been taken by now.
  std::string cause_at(double now) const {
    constexpr double kSilence = 5.0;  // s without any frame
    if (cause_.empty()) return "no depth image and no point cloud came";
    if (now - cause_at_ <= kSilence) return cause_;
    return "no frame came for " + number_text(now - cause_at_, 3) + " s; before, " + cause_;
  }

  void forget_misses() {
    missed_ = 0;
    missed_for_.clear();
  }

  void begin() {
    PipelineOptions options;
    options.seed = seed_;
    options.threads = threads_;
    pipeline_ = std::make_unique<Pipeline>(workcell_, parameters_, std::move(options));
    if (!joints_stamp_) joints_ = workcell_.start;
    goal_.reset();
    ++scans_;
    refused_ = 0;
    forget_misses();
    state_ = SessionState::idle;
  }

  void choose(double now) {
    goal_ = pipeline_->next_view(joints_);
    asked_at_ = now;
    cause_.clear();
    goals_ += goal_.has_value();
    state_ = goal_ ? SessionState::moving : SessionState::done;
  }

  Workcell workcell_;
  Parameters parameters_;
  SessionParameters session_;
  std::uint64_t seed_;
  int threads_;
  std::unique_ptr<Pipeline> pipeline_;
  SessionState state_ = SessionState::idle;
  std::optional<plan::ReachableView> goal_;
  std::size_t goals_ = 0, scans_ = 0;
  double asked_at_ = 0.0;
  Joints joints_ = Joints::Zero();
  std::optional<double> joints_stamp_;
  int refused_ = 0;
  int missed_ = 0;  // in a row
  std::string missed_for_, cause_;
  double cause_at_ = 0.0;  // when cause_ was told
};

}  // namespace agrisee::robot
