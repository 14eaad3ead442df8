// SPDX-License-Identifier: BSD-3-Clause
// Tells an arm's trajectory controller where to go and when to hold, for both generations of ROS; `Ros` as NodeCore has
// it.
#pragma once

#include "joint_names.hpp"
#include "scan_session.hpp"

namespace agrisee::robot {

/// Publishes `joint_goal`.
template <typename Ros>
class ArmGoals {
 public:
  static constexpr double kRecent = 0.2;    ///< joint states that are older (s) do not tell where the arm is
  static constexpr double kHoldTime = 0.5;  ///< in which the arm comes to rest at the joints where it holds (s)

  /// @param speed share of the joints' top speeds, above 0, at most 1  @param prefix of the joints' names
  ArmGoals(Ros& ros, double speed, const std::string& prefix) : ros_(ros), speed_(speed), names_(joint_names(prefix)) {}

  /// The joints of a new view; once no view is wanted any more, that the arm holds. An arm that was not sent anywhere
  /// since is left alone: something else may move it.
  void publish(const ScanSession& session) {
    if (const auto& view = session.goal()) {
      if (session.goals() == published_ || !view->joints) return;
      published_ = session.goals();
      under_way_ = true;
      send(*view->joints, std::max(view->move_time, 0.1) / speed_);
    } else if (under_way_) {
      under_way_ = false;
      hold(session);
    }
  }

 private:
  /// ROS 1's controller holds when it gets a trajectory without points. Newer ones of ROS 2 reject that, and go on to
  /// the last goal: they are sent to rest where the arm is. With joints of the past that would send it back.
  void hold(const ScanSession& session) {
    const auto& stamp = session.joints_stamp();
    const bool known = stamp && std::abs(ros_.now() - *stamp) <= kRecent;
    if (!Ros::kEmptyHolds && known) return send(session.joints(), kHoldTime, true);
    if (!Ros::kEmptyHolds)
      ros_.warn("No joint states of the last " + number_text(kRecent, 3) +
                " s: the arm is told to hold by an empty trajectory, which newer controllers reject");
    ros_.publish("joint_goal", trajectory());
  }

  typename Ros::JointTrajectory trajectory() const {
    typename Ros::JointTrajectory out;
    out.joint_names = names_;
    return out;
  }

  /// To joints (rad) within `duration` seconds; `at_rest` also states that the arm stands still there.
  void send(const Joints& joints, double duration, bool at_rest = false) {
    auto goal = trajectory();
    goal.points.resize(1);
    goal.points[0].positions.assign(joints.data(), joints.data() + 6);
    if (at_rest) goal.points[0].velocities.assign(6, 0.0);
    goal.points[0].time_from_start = ros_.duration(duration);
    ros_.publish("joint_goal", goal);
  }

  Ros& ros_;
  double speed_;
  std::vector<std::string> names_;
  std::size_t published_ = 0;  // ScanSession::goals() at the last goal
  bool under_way_ = false;     // the last that was published was a goal
};

}  // namespace agrisee::robot
