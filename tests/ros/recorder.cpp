// SPDX-License-Identifier: BSD-3-Clause
// Drives the node by its services, records what it publishes and compares it with the folder that `agrisee scan` left
// of the same scene. Usage: recorder RESULT TOLERANCE_M SAME_VIEWS(0|1)
#include <agrisee/arm/ur.hpp>
#include <agrisee/interop/ros.hpp>
#include <agrisee/io/results.hpp>

#include <deque>
#include <functional>
#include <geometry_msgs/PoseArray.h>
#include <iostream>
#include <ros/ros.h>
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

using namespace agrisee;

namespace {

int failures = 0;

void expect(bool ok, const std::string& what) {
  std::cout << (ok ? "ok      " : "FAILED  ") << what << "\n";
  failures += !ok;
}

/// The last message of a topic.
template <typename Message>
class Latest {
 public:
  Latest(ros::NodeHandle& node, const std::string& topic)
      : subscriber_(node.subscribe<Message>(topic, 50, [this](const boost::shared_ptr<const Message>& m) {
          last_ = m;
          ++count_;
        })) {}
  const boost::shared_ptr<const Message>& last() const { return last_; }
  int count() const { return count_; }

 private:
  boost::shared_ptr<const Message> last_;
  int count_ = 0;
  ros::Subscriber subscriber_;
};

bool spin_until(double seconds, const std::function<bool()>& ready) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(seconds);
  while (ros::ok() && ros::WallTime::now() < end) {
    ros::spinOnce();
    if (ready()) return true;
    ros::WallDuration(0.02).sleep();
  }
  return false;
}

Eigen::Vector3d position(const geometry_msgs::Pose& p) { return {p.position.x, p.position.y, p.position.z}; }

double nearest(const Eigen::Vector3d& p, const geometry_msgs::PoseArray& all) {
  double best = 1e9;
  for (const auto& q : all.poses) best = std::min(best, (position(q) - p).norm());
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "recorder");
  if (argc != 4) {
    std::cerr << "usage: recorder RESULT TOLERANCE_M SAME_VIEWS\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const double tolerance = std::stod(argv[2]);
  const bool same_views = std::string(argv[3]) == "1";
  const auto expected = io::read_fruits(folder / "fruits.json");
  const auto views = io::read_views(folder / "views.csv");

  ros::NodeHandle node;
  tf2_ros::Buffer buffer;
  tf2_ros::TransformListener listener(buffer);
  Latest<std_msgs::String> status(node, "/agrisee/status"), json(node, "/agrisee/fruits_json");
  Latest<geometry_msgs::PoseArray> fruits(node, "/agrisee/fruits"), bodies(node, "/agrisee/bodies"),
      candidates(node, "/agrisee/candidate_views"), pre_grasps(node, "/agrisee/pre_grasps");
  Latest<visualization_msgs::MarkerArray> fruit_markers(node, "/agrisee/fruit_markers"),
      view_markers(node, "/agrisee/view_markers");
  Latest<sensor_msgs::PointCloud2> cloud(node, "/agrisee/cloud");
  std::size_t most_candidates = 0;
  ros::Subscriber count_candidates = node.subscribe<geometry_msgs::PoseArray>(
      "/agrisee/candidate_views", 50,
      [&](const geometry_msgs::PoseArrayConstPtr& m) { most_candidates = std::max(most_candidates, m->poses.size()); });
  std::vector<Joints> goals;
  bool held = false;
  ros::Subscriber take_goals = node.subscribe<trajectory_msgs::JointTrajectory>(
      "/agrisee/joint_goal", 50, [&](const trajectory_msgs::JointTrajectoryConstPtr& m) {
        held = m->points.empty();
        if (held) return;
        sensor_msgs::JointState last;
        last.name = m->joint_names;
        last.position = m->points.back().positions;
        if (const auto q = robot::joints_of(last)) goals.push_back(*q);
      });
  // The links by tf against our kinematics, where the arm stands: between two joint states tf only interpolates.
  double worst_tf = 0.0;
  std::size_t postures = 0;
  std::deque<std::pair<ros::Time, Joints>> lately;
  Joints compared = Joints::Constant(99.0);
  ros::Subscriber take_joints =
      node.subscribe<sensor_msgs::JointState>("/joint_states", 50, [&](const sensor_msgs::JointStateConstPtr& m) {
        const auto q = robot::joints_of(*m);
        if (!q) return;
        lately.emplace_back(m->header.stamp, *q);
        if (lately.size() < 21) return;
        lately.pop_front();
        const ros::Time then = lately[10].first;
        if (lately.front().second != *q || *q == compared || !buffer.canTransform("base_link", "tool0", then)) return;
        const arm::LinkFrames frames = arm::link_frames(*q);
        const char* links[] = {"shoulder_link", "upper_arm_link", "forearm_link",
                               "wrist_1_link",  "wrist_2_link",   "tool0"};
        for (std::size_t i = 0; i < 6; ++i) {
          const Pose by_tf = robot::pose_of(buffer.lookupTransform("base_link", links[i], then).transform);
          worst_tf = std::max(worst_tf, (by_tf.matrix() - frames[i].matrix()).cwiseAbs().maxCoeff());
        }
        compared = *q;
        ++postures;
      });

  const auto call = [&](const std::string& name) {
    std_srvs::Trigger trigger;
    return ros::service::call("/agrisee/" + name, trigger) && trigger.response.success;
  };
  const auto says = [&](const std::string& text) {
    return status.last() && status.last()->data.compare(0, text.size(), text) == 0;
  };

  // All processes have to find each other first, which takes long on a busy machine.
  expect(spin_until(240.0, [&] { return says("idle") && take_goals.getNumPublishers() > 0; }),
         "the node says that it is idle");
  // The arm connects when we do, but nobody tells us when it has; a goal that it misses comes again only after a
  // minute.
  spin_until(2.0, [] { return false; });
  expect(spin_until(240.0, [&] { return postures > 0; }), "tf tells of the arm");
  if (failures) return 1;
  expect(!call("stop") && !call("skip_view"), "what is not going on cannot be stopped or skipped");
  expect(call("start"), "it starts");
  expect(!call("start"), "it does not start twice");
  const bool done = spin_until(600.0, [&] { return says("done"); });
  expect(done, "it ends: " + (status.last() ? status.last()->data : std::string("nothing heard")));
  if (!done) return 1;
  // The status is published last; what other topics carry may still be on its way.
  spin_until(60.0, [&] { return fruits.last() && fruits.last()->poses.size() == expected.size() && held; });

  expect(fruits.last() && bodies.last() && cloud.last() && fruit_markers.last() && view_markers.last() &&
             pre_grasps.last() && json.last(),
         "all topics were heard");
  if (failures) return 1;
  expect(fruits.last()->header.frame_id == "world", "poses are in world");
  const ros::Time stamp = fruits.last()->header.stamp;
  expect(bodies.last()->header.stamp == stamp && pre_grasps.last()->header.stamp == stamp &&
             cloud.last()->header.stamp == stamp && fruit_markers.last()->markers.front().header.stamp == stamp &&
             json.last()->data.find(R"({"stamp": {"sec": )" + std::to_string(stamp.sec) + R"(, "nanosec": )" +
                                    std::to_string(stamp.nsec) + R"(}, "fruits": [)") == 0,
         "what is published together has one stamp");
  expect(fruits.last()->poses.size() == expected.size(), std::to_string(fruits.last()->poses.size()) + " fruit, " +
                                                             std::to_string(expected.size()) + " by agrisee scan");
  double worst_pose = 0.0, worst_center = 0.0;
  std::size_t reachable = 0;
  for (const Fruit& f : expected) {
    worst_pose = std::max(worst_pose, nearest(f.position(), *fruits.last()));
    if (f.body) worst_center = std::max(worst_center, nearest(f.body->center, *bodies.last()));
    reachable += f.picking && f.picking->reachable;
  }
  expect(worst_center < tolerance,
         "bodies are where agrisee scan has them: " + std::to_string(1e3 * worst_center) + " mm");
  expect(worst_pose < tolerance, "so are the poses: " + std::to_string(1e3 * worst_pose) + " mm");
  if (same_views) {
    expect(goals.size() == views.size(),
           std::to_string(goals.size()) + " joint goals, " + std::to_string(views.size()) + " views by agrisee scan");
    double worst = 0.0;
    for (std::size_t i = 0; i < std::min(goals.size(), views.size()); ++i)
      worst = std::max(worst, (goals[i] - *views[i].joints).cwiseAbs().maxCoeff());
    expect(worst < 1e-3, "the goals are the views' joints: " + std::to_string(worst) + " rad");
    expect(pre_grasps.last()->poses.size() == reachable, std::to_string(reachable) + " pre-grasp poses");
  }
  expect(most_candidates > 10, std::to_string(most_candidates) + " candidate views");
  std::map<std::string, std::size_t> layers;
  for (const auto* markers : {&*fruit_markers.last(), &*view_markers.last()})
    for (const auto& m : markers->markers) ++layers[m.ns];
  expect(layers["bodies"] == expected.size() && layers["ids"] == expected.size() &&
             layers["frames"] == 3 * expected.size() && layers["taken"] == goals.size(),
         "a body, an id and a frame for each fruit, a pyramid for each view");
  const interop::PointCloud2View points(*cloud.last());
  std::size_t labelled = 0, finite = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::int32_t instance = 0;
    std::memcpy(&instance, cloud.last()->data.data() + cloud.last()->point_step * i + 28, 4);
    labelled += instance > 0;
    finite += is_finite(points.point(i));
  }
  const io::RunFile run = io::read_run(folder / "run.json");
  const auto about = [](std::size_t a, std::size_t b) {
    return std::abs(double(a) - double(b)) <= 0.1 * double(std::max<std::size_t>(b, 1));
  };
  expect(finite == points.size() && about(points.size(), run.filtered) && about(labelled, run.labelled),
         std::to_string(points.size()) + " points, " + std::to_string(labelled) + " of them of fruit");
  expect(postures > goals.size() / 2 && worst_tf < 1e-9, "tf agrees with our kinematics at " +
                                                             std::to_string(postures) +
                                                             " postures: " + std::to_string(1e12 * worst_tf) + " pm");

  const std::size_t before = goals.size();
  expect(call("reset"), "it is reset");
  expect(spin_until(60.0, [&] { return says("idle, 0 views") && fruits.last()->poses.empty(); }),
         "nothing is known then");
  expect(call("start") && spin_until(60.0, [&] { return goals.size() == before + 1; }), "it starts anew");
  expect(call("skip_view") && spin_until(60.0, [&] { return goals.size() == before + 2; }) &&
             (goals[before] - goals[before + 1]).norm() > 1e-3,
         "a view that is skipped is followed by another");
  expect(call("stop") && spin_until(60.0, [&] { return says("paused") && held; }), "it stops, and the arm is held");
  std::cout << (failures ? "FAILED\n" : "all is well\n");
  return failures ? 1 : 0;
}
