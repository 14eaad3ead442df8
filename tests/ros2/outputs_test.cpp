// SPDX-License-Identifier: BSD-3-Clause
// What the ROS 2 node publishes and writes, with a stand-in for ROS 2 (stand_in/graph.hpp).
#include <agrisee/io/results.hpp>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "catch.hpp"
#include "robot.hpp"

using namespace agrisee;
using test::Ear;
using test::latched;
using test::Mouth;
using test::Robot;

TEST_CASE("topics have the quality of service that sensors and late listeners need") {
  Robot robot({{"channels.color", true}});
  REQUIRE(robot.bring_up() == "active");
  // Best effort is heard, as is a driver that is reliable.
  CHECK(robot.depth.listeners() == 1);
  CHECK(Mouth<sensor_msgs::msg::Image>("/depth/image", rclcpp::QoS(5)).listeners() == 1);
  CHECK(robot.info.listeners() == 1);
  CHECK(robot.points.listeners() == 1);
  CHECK(robot.joint_states.listeners() == 1);
  CHECK(robot.color.listeners() == 1);
  CHECK(robot.labels.listeners() == 0);  // not asked for
  for (const char* topic : {"joint_goal", "chosen_view", "candidate_views", "view_markers", "cloud", "fruits", "bodies",
                            "fruit_markers", "pre_grasps", "fruits_json", "status"}) {
    INFO(topic);
    const auto& writers = stand_in::graph().topics.at(std::string("/agrisee/") + topic).writers;
    REQUIRE_FALSE(writers.empty());
    const auto writer = writers.back().lock();
    REQUIRE(writer);
    CHECK(writer->qos.reliable);
    CHECK(writer->qos.depth == 1);
    const bool passing = std::string(topic) == "joint_goal" || std::string(topic) == "chosen_view";
    CHECK(writer->qos.transient_local == !passing);
  }
  const auto& images = stand_in::graph().topics.at("/depth/image").readers;
  REQUIRE(images.back().lock());
  CHECK(images.back().lock()->qos.depth == 1);
}

TEST_CASE("what is published together has one stamp, and tells all of the fruit") {
  Robot robot;
  const Ear<geometry_msgs::msg::PoseArray> bodies("/agrisee/bodies", latched()),
      grasps("/agrisee/pre_grasps", latched());
  const Ear<sensor_msgs::msg::PointCloud2> cloud("/agrisee/cloud", latched());
  const Ear<std_msgs::msg::String> json("/agrisee/fruits_json", latched());
  stand_in::graph().clock_step = 1000;  // the clock goes on while the node publishes
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  robot.go();
  robot.look();
  REQUIRE(robot.status_says("moving, 1 views"));
  stand_in::graph().clock_step = 0;
  const auto& stamp = robot.fruits.last->header.stamp;
  CHECK(bodies.last->header.stamp == stamp);
  CHECK(grasps.last->header.stamp == stamp);
  CHECK(cloud.last->header.stamp == stamp);
  CHECK(robot.chosen.last->header.stamp == stamp);
  REQUIRE(json.last);
  const auto text = nlohmann::json::parse(json.last->data);
  CHECK(text.at("stamp").at("sec") == stamp.sec);
  CHECK(text.at("stamp").at("nanosec") == stamp.nanosec);
  REQUIRE(text.at("fruits").size() == robot.fruits.last->poses.size());
  REQUIRE_FALSE(text.at("fruits").empty());
  for (const char* key : {"id", "radii", "confidence", "picking_order", "reachable"})
    CHECK(text.at("fruits").at(0).contains(key));
}

TEST_CASE("fruit whose colors are seen have a ripeness") {
  Robot robot({{"channels.color", true}, {"channels.labels", true}});
  const Ear<visualization_msgs::msg::MarkerArray> markers("/agrisee/fruit_markers", latched());
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  while (robot.status_says("moving")) {
    robot.go();
    auto color = robot.image("bgr8", 3);
    for (std::size_t i = 0; i < color.data.size(); ++i) color.data[i] = std::array<std::uint8_t, 3>{35, 40, 190}[i % 3];
    robot.color.say(color);
    robot.labels.say(robot.labels_of_fruit());
    robot.look();
  }
  CHECK(robot.status_says("done, "));
  REQUIRE(robot.fruits.last->poses.size() == 2);
  std::vector<std::string> texts;
  for (const auto& marker : markers.last->markers)
    if (marker.ns == "ids") texts.push_back(marker.text);
  CHECK(texts == std::vector<std::string>{"1, red", "2, red"});
}

TEST_CASE("results are written as agrisee scan writes them, each scan's into a folder of its own") {
  namespace fs = std::filesystem;
  const fs::path output = fs::temp_directory_path() / "agrisee_ros2_output";
  fs::remove_all(output);
  const auto folders = [&] {
    std::set<fs::path> found;
    for (const auto& entry : fs::directory_iterator(output)) found.insert(entry.path());
    return found;
  };
  Robot robot({{"output", output.string()}, {"seed", 7}});
  REQUIRE(robot.bring_up() == "active");
  robot.call("start");
  robot.go();
  robot.look();
  CHECK(folders().empty());
  robot.call("stop");
  REQUIRE(folders().size() == 1);
  const fs::path first = *folders().begin();
  CHECK(io::read_run(first / "run.json").views == 1);
  robot.call("start");
  while (robot.status_says("moving")) {
    robot.go();
    robot.look();
  }
  REQUIRE(folders().size() == 1);
  const io::RunFile run = io::read_run(first / "run.json");
  CHECK(run.views >= 2);
  CHECK(run.info.scene == "two fruit");
  CHECK(run.info.seed == 7);
  CHECK(io::read_fruits(first / "fruits.json").size() == 2);
  for (const char* name : io::kResultFiles) CHECK(fs::exists(first / name));
  CHECK(Robot::said("The result is in " + first.string()));
  robot.call("start");  // another scan
  robot.go();
  robot.look();
  robot.call("stop");
  CHECK(folders().size() == 2);
  // What cannot be written is told, and the scan goes on.
  robot.call("reset");
  fs::remove_all(output);
  std::ofstream(output) << "a file";
  robot.call("start");
  robot.go();
  robot.look();
  robot.call("stop");
  CHECK(robot.status_says("paused, 1 views"));
  CHECK(Robot::said("[warn] The result is not written: " + output.string()));
  fs::remove_all(output);
}
