// SPDX-License-Identifier: BSD-3-Clause
// The ROS 2 node as it is, with message types by rosidl and a stand-in for rclcpp and tf2 (stand_in/graph.hpp).
#include <functional>

#include "catch.hpp"
#include "robot.hpp"
#include "support/says.hpp"

using namespace agrisee;
using rclcpp::Parameter;
using test::Ear;
using test::latched;
using test::Mouth;
using test::Robot;

TEST_CASE("the node leads a scan from the service to the fruit, by images or by points") {
  for (const bool by_points : {false, true}) {
    Robot robot;
    REQUIRE(robot.bring_up() == "active");
    CHECK(robot.status_says("idle, 0 views"));
    REQUIRE(robot.call("start").success);
    CHECK(robot.call("start").message == "a scan is going on");
    int goals = 0;
    while (robot.status_says("moving")) {
      REQUIRE(++goals <= 3);
      REQUIRE(robot.joint_goal.last->points.size() == 1);
      CHECK(robot.joint_goal.last->joint_names.size() == 6);
      CHECK(robot.joint_goal.last->points[0].positions.size() == 6);
      const auto& time = robot.joint_goal.last->points[0].time_from_start;
      CHECK(time.sec + 1e-9 * time.nanosec >= 0.1);
      robot.go();
      by_points ? robot.look_by_points() : robot.look();
    }
    CHECK(robot.status_says("done, "));
    CHECK(goals >= 2);
    CHECK(robot.held_at(robot.joints));
    REQUIRE(robot.fruits.last->poses.size() == 2);
    CHECK(robot.fruits.last->header.frame_id == "world");
    for (const auto& pose : robot.fruits.last->poses) {
      const Eigen::Vector3d at(pose.position.x, pose.position.y, pose.position.z);
      CHECK(std::any_of(test::kTwoFruit.begin(), test::kTwoFruit.end(),
                        [&](const Sphere& s) { return (s.center - at).norm() < 0.003; }));
    }
    // Whoever comes late hears the result, but no old goal.
    const Ear<sensor_msgs::msg::PointCloud2> cloud("/agrisee/cloud", latched());
    const Ear<visualization_msgs::msg::MarkerArray> markers("/agrisee/fruit_markers", latched());
    const Ear<trajectory_msgs::msg::JointTrajectory> goal("/agrisee/joint_goal");
    const Ear<geometry_msgs::msg::PoseStamped> chosen("/agrisee/chosen_view", latched());
    REQUIRE(cloud.last);
    CHECK(cloud.last->fields.back().name == "instance");
    CHECK(interop::PointCloud2View(*cloud.last).size() > 500);
    REQUIRE(markers.last);
    CHECK(markers.last->markers.size() > 2);
    CHECK(goal.count == 0);
    CHECK(chosen.count == 0);
    CHECK_FALSE(Robot::said("Left out"));
  }
}

TEST_CASE("services stop, reset and skip views, and refuse what makes no sense") {
  Robot robot;
  CHECK(robot.call("start").message == "the node is not active");
  REQUIRE(robot.bring_up() == "active");
  CHECK(robot.call("stop").message == "no scan is going on");
  CHECK(robot.call("skip_view").message == "no view was asked for");
  REQUIRE(robot.call("start").success);
  const Pose first = *robot.goal();
  REQUIRE(robot.call("skip_view").success);
  CHECK((robot.goal()->matrix() - first.matrix()).norm() > 1e-3);
  CHECK(robot.joint_goal.count >= 2);
  robot.go();
  robot.look();
  REQUIRE(robot.call("stop").success);
  CHECK(robot.status_says("paused, 1 views"));
  CHECK(robot.held_at(robot.joints));
  robot.look();  // nobody asked for it
  CHECK(robot.status_says("paused, 1 views"));
  REQUIRE(robot.call("start").success);
  CHECK(robot.status_says("moving, 1 views"));
  REQUIRE(robot.call("reset").success);
  CHECK(robot.status_says("idle, 0 views"));
}

TEST_CASE("a node that is deactivated holds the arm, keeps what was seen and goes on") {
  Robot robot;
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  robot.go();
  robot.look();
  REQUIRE(robot.status_says("moving, 1 views"));
  REQUIRE(robot.node->deactivate().label() == "inactive");
  CHECK(robot.held_at(robot.joints));
  CHECK(robot.depth.listeners() == 0);
  const int heard = robot.status.count;
  stand_in::fire_timers();
  CHECK_FALSE(robot.call("start").success);
  CHECK(robot.status.count == heard);
  REQUIRE(robot.node->activate().label() == "active");
  CHECK(robot.status_says("paused, 1 views"));
  REQUIRE(robot.call("start").success);
  CHECK(robot.status_says("moving, 1 views"));
  const Joints under_way = robot.joints.array() + 0.1;
  robot.tell_joints(under_way);
  REQUIRE(robot.node->shutdown().label() == "finalized");
  CHECK(robot.held_at(under_way));
}

TEST_CASE("an arm that was not sent anywhere is left alone") {
  Robot robot;
  REQUIRE(robot.bring_up() == "active");
  robot.call("reset");
  REQUIRE(robot.node->deactivate().label() == "inactive");
  REQUIRE(robot.node->activate().label() == "active");
  CHECK(robot.joint_goal.count == 0);
  robot.call("start");
  robot.go();
  robot.call("stop");
  CHECK(robot.joint_goal.count == 2);
  robot.call("reset");
  CHECK(robot.joint_goal.count == 2);  // it holds already
}

TEST_CASE("an arm holds where it is, not where it was before the node was busy") {
  Robot robot;
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  robot.go();
  stand_in::graph().busy = true;
  const Joints under_way = robot.joints.array() + 0.2;
  robot.tell_joints(robot.joints.array() + 0.1);
  Robot::pass(1.0);
  robot.tell_joints(under_way);
  robot.call("stop");
  stand_in::hand_over();
  CHECK(robot.held_at(under_way));
  CHECK_FALSE(Robot::said("[warn]"));
  // Who does not know where it is does not send it back.
  robot.call("start");
  Robot::pass(1.0);
  robot.call("stop");
  CHECK(robot.joint_goal.last->points.empty());
  CHECK(Robot::said("[warn] No joint states of the last 0.2 s"));
}

TEST_CASE("a frame waits for its colors and labels and is taken with them") {
  Robot robot({{"channels.color", true}, {"channels.labels", true}, {"channels.score", 0.9}});
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  robot.go();
  robot.look();
  const auto color = robot.image("bgr8", 3), labels = robot.image("16UC1", 2);
  auto foreign = color;
  foreign.header.stamp.sec = -5;  // rclcpp::Time would throw
  robot.color.say(foreign);
  CHECK(robot.status_says("moving, 0 views"));
  robot.color.say(color);
  CHECK(robot.status_says("moving, 0 views"));
  Robot::pass(0.4);
  robot.labels.say(labels);
  CHECK(robot.status_says("moving, 1 views"));
  CHECK_FALSE(Robot::said("go without"));
  CHECK_FALSE(Robot::said("Left out"));
  // What does not fit is told, and the view is not lost.
  robot.go();
  robot.look();
  robot.color.say(robot.image("mono8", 1));
  robot.labels.say(robot.image("8UC1", 1));
  CHECK(robot.status_says("moving, 1 views"));
  CHECK(Robot::said("Left out: Image: color: the encoding has to be rgb8 or bgr8, got 'mono8'"));
  // A detector that is silent does not hold it up.
  Robot::pass(0.1);
  for (int i = 0; i < 3; ++i) {
    robot.tell_joints();
    robot.look();
    Robot::pass(0.6);
  }
  CHECK(robot.status_says("moving, 2 views"));
  CHECK(Robot::said("the frame goes without"));
}

TEST_CASE("what cannot be used is left out with a message") {
  Robot robot;
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  robot.go();
  auto bad = robot.image("rgb8", 3);
  robot.depth.say(bad);  // no camera info yet
  CHECK_FALSE(Robot::said("Left out"));
  robot.info.say(robot.camera_info());
  robot.depth.say(bad);
  CHECK(Robot::said("Left out: Image: encoding has to be 16UC1 or 32FC1, got 'rgb8'"));
  robot.lost = true;
  robot.look();
  CHECK(Robot::said("Left out: no transform from camera to world"));
  auto early = robot.image("32FC1", 4);
  early.header.stamp = rclcpp::Time(std::int64_t{1000});  // of a clock that has just begun
  robot.lost = false;
  robot.depth.say(early);
  early.header.stamp.sec = -5;  // rclcpp::Time would throw
  robot.depth.say(early);
  sensor_msgs::msg::JointState state;
  state.header.stamp.sec = -5;
  state.name.assign(robot::kJointNames.begin(), robot::kJointNames.end());
  state.position.assign(6, 0.0);
  robot.joint_states.say(state);
  CHECK(robot.status_says("moving, 0 views"));
  robot.tell_joints();
  robot.look();
  CHECK(robot.status_says("moving, 1 views"));
}

TEST_CASE("a view that is not reached in time is followed by another") {
  Robot robot({{"arrival.move_timeout", 20}});  // a whole number for a real one
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  const Pose first = *robot.goal();
  Robot::pass(19.0);
  stand_in::fire_timers();
  CHECK((robot.goal()->matrix() - first.matrix()).norm() < 1e-12);
  Robot::pass(2.0);
  stand_in::fire_timers();
  CHECK((robot.goal()->matrix() - first.matrix()).norm() > 1e-3);
  CHECK(Robot::said("[warn] The view was not taken in time: no depth image and no point cloud came"));
}

TEST_CASE("why a view could not be taken is told") {
  Robot robot({{"channels.color", true}});
  REQUIRE(robot.bring_up() == "active");
  const auto given_up = [&](const std::function<void()>& before, const std::string& text) {
    robot.call("start");
    Robot::pass(58.0);
    before();
    Robot::pass(3.0);
    stand_in::fire_timers();
    INFO(robot.status.last->data);
    CHECK(robot.status_says("moving, 0 views"));
    CHECK(robot.status.last->data.find("(" + text) != std::string::npos);
    CHECK(Robot::said("[warn] The view was not taken in time: " + text));
    robot.call("stop");
  };
  given_up([] {}, "no depth image and no point cloud came");
  given_up([&] { robot.depth.say(robot.image("32FC1", 4)); }, "depth images came, but no camera info");
  given_up(
      [&] {
        robot.go_astray(0.05);
        robot.look();
      },
      "the sensor is 50 mm and ");
  given_up(
      [&] {
        robot.go();
        Robot::pass(1.0);
        robot.look();
      },
      "the last joint states are 1 s older than the frame");
  given_up(
      [&] {
        robot.go();
        robot.lost = true;
        robot.look();
        robot.lost = false;
      },
      "no transform from camera to world");
  auto image = robot.image("32FC1", 4);
  image.header.stamp = rclcpp::Time(std::int64_t{5000000000});
  given_up([&] { robot.depth.say(image); },
           "the frame is from before the arm could have stood at the view; its stamp is ");
  CHECK(Robot::said("s behind the node's clock: sensor and node must share one"));
  image.header.stamp = builtin_interfaces::msg::Time();
  given_up([&] { robot.depth.say(image); }, "the frame has no usable stamp");
  given_up(
      [&] {
        robot.go();
        robot.look();
      },
      "the depth image's colors or labels did not come");
}

TEST_CASE("a scan that gets no frame is stopped after three views, with the cause") {
  Robot robot;
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  const auto wait = [] {
    Robot::pass(61.0);
    stand_in::fire_timers();
  };
  wait();
  wait();
  CHECK(robot.status_says("moving, 0 views, 2 refused"));
  Robot::pass(60.0);
  robot.tell_joints(robot.joints);
  Robot::pass(0.1);
  stand_in::fire_timers();
  CHECK(robot.status_says("paused, 0 views, 3 refused (no depth image and no point cloud came)"));
  CHECK(Robot::said("came; 3 in a row: the scan stops, start goes on with this view"));
  CHECK(robot.held_at(robot.joints));
  const int goals = robot.joint_goal.count;
  wait();
  CHECK(robot.joint_goal.count == goals);
  REQUIRE(robot.call("start").success);
  robot.go();
  robot.look();
  CHECK(robot.status_says("moving, 1 views, 3 refused"));
  CHECK(robot.status.last->data.find('(') == std::string::npos);
}

TEST_CASE("joints have a prefix, and other names are noticed") {
  Robot robot({Parameter("joint_prefix", "left_")});
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  CHECK(robot.joint_goal.last->joint_names == robot::joint_names("left_"));
  stand_in::fire_timers();
  CHECK_FALSE(Robot::said("[warn]"));
  robot.tell_joints();  // without it
  stand_in::fire_timers();
  CHECK(Robot::said("[warn] joint_states do not name all of left_shoulder_pan_joint"));
  CHECK(Robot::said("they name wrist_3_joint wrist_2_joint"));
  stand_in::graph().log.clear();
  stand_in::fire_timers();
  CHECK_FALSE(Robot::said("joint_states"));  // once
  robot.joint_prefix = "left_";
  robot.tell_joints();
  robot.call("stop");
  CHECK(robot.held_at(robot.joints));
}

TEST_CASE("autostart waits for joints, and for somebody who moves the arm") {
  Robot robot({{"autostart", true}});
  REQUIRE(robot.bring_up() == "active");
  stand_in::fire_timers();
  CHECK(robot.status_says("idle"));
  sensor_msgs::msg::JointState state;
  state.header.stamp = Robot::stamp();
  state.name.assign(robot::kJointNames.begin(), robot::kJointNames.end());
  state.position.assign(Workcell().start.data(), Workcell().start.data() + 6);
  robot.joint_states.say(state);
  stand_in::fire_timers();
  CHECK(robot.status_says("moving"));
}
