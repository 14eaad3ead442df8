// SPDX-License-Identifier: BSD-3-Clause
// What a scan node publishes, for both generations of ROS; `Ros` as NodeCore has it.
#pragma once

#include "arm_goals.hpp"
#include "messages.hpp"
#include "node_parameters.hpp"

namespace agrisee::robot {

/// Publishes what a session knows and wants.
template <typename Ros>
class NodeOutputs {
 public:
  /// Both are kept by reference.
  NodeOutputs(Ros& ros, const NodeParameters& parameters) : ros_(ros), own_(parameters), arm_(ros, parameters.speed) {}

  /// f(topic, message, latched) for everything that is published; the message only tells its type. Joint goals and
  /// chosen views are not latched: whoever connects late must not be sent off by an old one.
  template <typename F>
  static void list(F&& f) {
    f("joint_goal", typename Ros::JointTrajectory(), false);
    f("chosen_view", typename Ros::PoseStamped(), false);
    f("candidate_views", typename Ros::PoseArray(), true);
    f("view_markers", typename Ros::MarkerArray(), true);
    f("cloud", typename Ros::PointCloud2(), true);
    f("fruits", typename Ros::PoseArray(), true);
    f("bodies", typename Ros::PoseArray(), true);
    f("fruit_markers", typename Ros::MarkerArray(), true);
    f("pre_grasps", typename Ros::PoseArray(), true);
    f("status", typename Ros::String(), true);
  }

  /// Everything that a session knows now. The joint goal goes first: the arm moves while the rest is computed; the
  /// status last.
  void publish(const ScanSession& session) {
    arm_.publish(session);
    publish_views(session);
    publish_result(session.pipeline().result());
    typename Ros::String status;
    status.data = session.status();
    ros_.publish("status", status);
    ros_.info(status.data);
  }

 private:
  using Header = decltype(Ros::PoseStamped::header);

  Header header() const {
    Header h;
    h.stamp = ros_.stamp();
    h.frame_id = own_.world_frame;
    return h;
  }

  void publish_poses(const char* topic, const std::vector<Pose>& poses) {
    ros_.publish(topic, pose_array<typename Ros::PoseArray>(header(), poses));
  }

  void publish_views(const ScanSession& session) {
    const Pipeline& pipeline = session.pipeline();
    const auto candidates = session.goal() ? pipeline.candidates() : std::vector<plan::ReachableView>{};
    std::vector<Pose> poses;
    for (const auto& c : candidates) poses.push_back(c.world_T_optical);
    publish_poses("candidate_views", poses);
    if (session.goal()) {
      typename Ros::PoseStamped chosen;
      chosen.header = header();
      chosen.pose = pose_message<decltype(chosen.pose)>(session.goal()->world_T_optical);
      ros_.publish("chosen_view", chosen);
    }
    MarkerMaker<typename Ros::MarkerArray> markers(header());
    markers.views(pipeline.views(), candidates, session.goal(), pipeline.workcell().sensor.intrinsics);
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

  Ros& ros_;
  const NodeParameters& own_;
  ArmGoals<Ros> arm_;
};

}  // namespace agrisee::robot
