// SPDX-License-Identifier: BSD-3-Clause
// The parameters of the ROS 2 node, with a stand-in for ROS 2 (stand_in/graph.hpp).
#include "catch.hpp"
#include "robot.hpp"

using namespace agrisee;
using test::Robot;

TEST_CASE("bad parameters keep the node unconfigured and are named") {
  const auto refused = [](const std::vector<rclcpp::Parameter>& parameters, const char* text) {
    Robot robot(parameters);
    INFO(text);
    CHECK(robot.bring_up() == "unconfigured");
    CHECK(Robot::said(std::string("[error] ") + text));
  };
  refused({{"workcell", ""}}, "parameter 'workcell' has to name a scene file");
  refused({{"workcell", "/nowhere/cell.yaml"}}, "/nowhere/cell.yaml");
  refused({{"output", "/dev/null/results"}}, "/dev/null/results: cannot be created");
  refused({{"max_view", 3}}, "unknown parameter 'max_view'");
  refused({{"arrival.setle", 3.0}}, "unknown parameter 'arrival.setle'");
  refused({{"max_views", 3.5}}, "parameter 'max_views' has to be a whole number");
  refused({{"max_views", std::int64_t{1} << 40}}, "parameter 'max_views' has to be a whole number of 32 bits");
  refused({{"rectified", 1}}, "parameter 'rectified' has to be true or false");
  refused({{"world_frame", 1}}, "parameter 'world_frame' has to be a text");
  refused({{"speed", "fast"}}, "parameter 'speed' has to be a number");
  refused({{"speed", 2.0}}, "speed must be above 0 and at most 1, got 2");
  refused({{"seed", -1}}, "seed must be zero or more, got -1");
  refused({{"channels.score", 3}}, "channels.score must be from 0 to 1, got 3");
  refused({{"split.bodies.radius_min", 0.0}}, "split.bodies.radius_min must be");
  refused({{"preset", "other"}}, "preset must be");
}

TEST_CASE("a node that was refused or cleaned up can be set right and configured again") {
  Robot robot({{"speed", 2.0}, {"use_sim_time", true}, {"qos_overrides./tf.subscription.depth", 10}});
  REQUIRE(robot.bring_up() == "unconfigured");
  robot.node->set_parameter({"speed", 0.5});
  REQUIRE(robot.bring_up() == "active");
  const bool fused = robot.node->get_parameter("fuse_surfaces").get_parameter_value().get<bool>();
  CHECK(fused);
  REQUIRE(robot.node->deactivate().label() == "inactive");
  REQUIRE(robot.node->cleanup().label() == "unconfigured");
  CHECK_FALSE(robot.node->has_parameter("fuse_surfaces"));  // it had the value of the preset
  CHECK(robot.node->has_parameter("speed"));
  const auto sets = robot.node->get_parameter("max_views").get_parameter_value();
  CHECK(sets.get<std::int64_t>() == 3);
  REQUIRE(robot.bring_up() == "active");
  CHECK(robot.status_says("idle, 0 views"));
}

TEST_CASE("parameters cannot be set once they have been read") {
  Robot robot({{"speed", 0.5}, {"use_sim_time", false}});
  REQUIRE(robot.bring_up() == "active");
  const auto speed = [&] { return robot.node->get_parameter("speed").get_parameter_value().get<double>(); };
  const auto refused = [&] {
    const auto answer = robot.node->set_parameter({"speed", 0.2});
    return !answer.successful &&
           answer.reason == "'speed' is read when the node is configured: deactivate it and clean it up first";
  };
  CHECK(refused());
  CHECK(robot.node->set_parameter({"use_sim_time", true}).successful);  // not ours
  robot.node->deactivate();
  CHECK(refused());
  CHECK(speed() == 0.5);
  robot.node->cleanup();
  CHECK(robot.node->set_parameter({"speed", 0.2}).successful);
  REQUIRE(robot.bring_up() == "active");
  CHECK(speed() == 0.2);
}
