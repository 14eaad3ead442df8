// SPDX-License-Identifier: BSD-3-Clause
// What a scan node publishes, for both generations of ROS; `Ros` as NodeCore has it.
#pragma once

#include "arm_goals.hpp"
#include "messages.hpp"
#include "result_writer.hpp"

namespace agrisee::robot {

/// Publishes what a session knows and wants.
template <typename Ros>
class NodeOutputs {
 public:
  /// @throws FileError when the folder `output` cannot be made
  NodeOutputs(Ros& ros, const NodeSetup& setup)
      : ros_(ros),
        world_frame_(setup.node.world_frame),
        arm_(ros, setup.node.speed, setup.node.joint_prefix),
        files_(setup) {}

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
    f("fruits_json", typename Ros::String(), true);
    f("status", typename Ros::String(), true);
  }

  /// Everything that a session knows now, with one stamp. The joint goal goes first: the arm moves while the rest is
  /// computed; then the files, if there are any; the status last.
  void publish(const ScanSession& session) {
    arm_.publish(session);
    Header header;
    header.stamp = ros_.stamp();
    header.frame_id = world_frame_;
    publish_views(session, header);
    const ScanResult result = session.pipeline().result();
    publish_result(result, header);
    write(session, result);
    typename Ros::String status;
    status.data = session.status();
    ros_.publish("status", status);
    ros_.info(status.data);
  }

 private:
  using Header = decltype(Ros::PoseStamped::header);

  void publish_poses(const char* topic, const Header& header, const std::vector<Pose>& poses) {
    ros_.publish(topic, pose_array<typename Ros::PoseArray>(header, poses));
  }

  void publish_views(const ScanSession& session, const Header& header) {
    const Pipeline& pipeline = session.pipeline();
    const auto candidates = session.goal() ? pipeline.candidates() : std::vector<plan::ReachableView>{};
    std::vector<Pose> poses;
    for (const auto& c : candidates) poses.push_back(c.world_T_optical);
    publish_poses("candidate_views", header, poses);
    if (session.goal()) {
      typename Ros::PoseStamped chosen;
      chosen.header = header;
      chosen.pose = pose_message<decltype(chosen.pose)>(session.goal()->world_T_optical);
      ros_.publish("chosen_view", chosen);
    }
    MarkerMaker<typename Ros::MarkerArray> markers(header);
    markers.views(pipeline.views(), candidates, session.goal(), pipeline.workcell().sensor.intrinsics);
    ros_.publish("view_markers", markers.take());
  }

  void publish_result(const ScanResult& result, const Header& header) {
    typename Ros::PointCloud2 cloud;
    cloud.header = header;
    fill_cloud(cloud, result.cloud, result.labels);
    ros_.publish("cloud", cloud);
    const ResultPoses poses = result_poses(result.fruits);
    publish_poses("fruits", header, poses.fruits);
    publish_poses("bodies", header, poses.bodies);
    publish_poses("pre_grasps", header, poses.pre_grasps);
    MarkerMaker<typename Ros::MarkerArray> markers(header);
    markers.fruits(result.fruits);
    ros_.publish("fruit_markers", markers.take());
    typename Ros::String json;
    json.data = R"({"stamp": {"sec": )" + std::to_string(header.stamp.sec) + R"(, "nanosec": )" +
                std::to_string(Ros::nanoseconds(header.stamp)) + R"(}, "fruits": )" +
                io::fruits_to_json(result.fruits) + "}";
    ros_.publish("fruits_json", json);
  }

  void write(const ScanSession& session, const ScanResult& result) {
    try {
      const auto folder = files_.write(session, result);
      if (!folder.empty()) ros_.info("The result is in " + folder.string());
    } catch (const Error& e) {
      ros_.warn(std::string("The result is not written: ") + e.what());
    }
  }

  Ros& ros_;
  std::string world_frame_;
  ArmGoals<Ros> arm_;
  ResultWriter files_;
};

}  // namespace agrisee::robot
