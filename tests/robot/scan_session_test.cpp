// SPDX-License-Identifier: BSD-3-Clause
// What the ROS nodes share, without ROS: when a frame is taken, refusals, stop and reset, parameters by name.
#include "scan_session.hpp"

#include <map>
#include <variant>

#include "catch.hpp"
#include "joint_names.hpp"
#include "messages.hpp"
#include "read_parameters.hpp"
#include "spheres.hpp"
#include "support/says.hpp"

using namespace agrisee;
using robot::ScanSession;
using robot::SessionState;

namespace {

const std::vector<Sphere> kFruit = {{{-0.03, 0.53, 0.2}, 0.035}, {{0.045, 0.54, 0.21}, 0.033}};

Workcell cell() {
  Workcell w;
  w.scan_volume.extend({-0.17, 0.40, -0.02});
  w.scan_volume.extend({0.17, 0.72, 0.42});
  w.keep_out.push_back({"cluster", Cylinder{{0.015, 0.545, 0.21}, 0.30, 0.9}});
  w.sensor.intrinsics = sensor::intrinsics_from_fov(256, 192, deg(70), deg(55));
  return w;
}

Parameters few_views() {
  Parameters p;
  p.max_views = 3;
  return p;
}

sensor::DepthFrame look(const Pose& pose) { return test::render(kFruit, cell().sensor.intrinsics, pose); }

}  // namespace

TEST_CASE("a frame is taken once the sensor has arrived and stands still") {
  ScanSession session(cell(), few_views());
  CHECK(session.state() == SessionState::idle);
  CHECK(session.objection(100.0, Pose::Identity(), Pose::Identity()) == "no view was asked for");
  CHECK_THROWS_AS(session.observe(look(Pose::Identity()), Pose::Identity(), 1.0), InputError);
  REQUIRE(session.start(10.0));
  CHECK_FALSE(session.start(10.0));
  REQUIRE(session.goal());
  const Pose goal = session.goal()->world_T_optical;
  const auto moved = [&](double x, double turn) { return Pose(goal * pose_from_xyz_rpy({x, 0, 0}, {0, 0, turn})); };
  CHECK(session.objection(10.31, goal, goal).empty());
  CHECK_THAT(session.objection(10.29, goal, goal), test::says("before the arm could have stood"));
  CHECK(session.objection(12.0, moved(0.021, 0.0), moved(0.021, 0.0)) ==
        "the sensor is 21 mm and 0 rad from the view, 20 mm and 0.05 rad are allowed");
  CHECK_THAT(session.objection(12.0, moved(0.0, 0.06), moved(0.0, 0.06)), test::says("0.06 rad from the view"));
  CHECK(session.objection(12.0, goal, moved(0.001, 0.0)) ==
        "the sensor does not stand still: it moved by 1 mm and 0 rad in 0.3 s");
  CHECK_THAT(session.objection(12.0, goal, moved(0.0, 0.005)), test::says("0.005 rad in 0.3 s"));
  CHECK(session.objection(12.0, moved(0.01, 0.03), moved(0.01, 0.03)).empty());  // near enough
  session.set_joints(cell().start, 11.6);                                        // where the arm was before it stood
  CHECK(session.objection(12.0, goal, goal) == "the last joint states are 0.4 s older than the frame");
  session.set_joints(*session.goal()->joints, 11.8);
  CHECK(session.objection(12.0, goal, goal).empty());
}

TEST_CASE("a session leads a scan to its end, and another after it") {
  ScanSession session(cell(), few_views());
  for (int scan = 0; scan < 2; ++scan) {
    REQUIRE(session.start(0.0));
    double t = 0.0;
    while (session.state() == SessionState::moving) {
      t += 1.0;
      const Pose pose = session.goal()->world_T_optical;
      session.set_joints(*session.goal()->joints, t);
      REQUIRE(session.objection(t, pose, pose).empty());
      session.observe(look(pose), pose, t);
    }
    CHECK(session.state() == SessionState::done);
    CHECK_FALSE(session.goal());
    CHECK(session.pipeline().views().size() >= 2);
    CHECK(session.pipeline().result().fruits.size() == kFruit.size());
    CHECK_THAT(session.status(), test::says("done, "));
  }
}

TEST_CASE("candidates are told, the chosen view among the best of them") {
  ScanSession session(cell(), few_views());
  session.start(0.0);
  CHECK(session.pipeline().candidates().empty());  // nothing was seen yet, nothing to compare
  const Pose pose = session.goal()->world_T_optical;
  session.observe(look(pose), pose, 1.0);
  const auto candidates = session.pipeline().candidates();
  REQUIRE(candidates.size() > 10);
  REQUIRE(session.goal());
  CHECK(std::any_of(candidates.begin(), candidates.end(), [&](const plan::ReachableView& c) {
    return (c.world_T_optical.matrix() - session.goal()->world_T_optical.matrix()).norm() < 1e-9;
  }));
  for (const auto& c : candidates) CHECK(c.gain > 0.0);
}

TEST_CASE("a bad frame leaves a session where it was") {
  ScanSession session(cell(), few_views());
  session.start(0.0);
  const Pose pose = session.goal()->world_T_optical;
  sensor::DepthFrame frame = look(pose);
  frame.depth.pop_back();
  CHECK_THROWS_AS(session.observe(frame, pose, 1.0), InputError);
  CHECK(session.state() == SessionState::moving);
  CHECK(session.goals() == 1);
  CHECK(session.pipeline().views().empty());
  session.observe(look(pose), pose, 1.0);
  CHECK(session.pipeline().views().size() == 1);
  Joints bad = Joints::Zero();
  bad[2] = std::nan("");
  CHECK_THROWS_AS(session.set_joints(bad, 0.0), InputError);
}

TEST_CASE("a view that is refused or not reached in time is followed by another") {
  ScanSession session(cell(), few_views());
  CHECK_FALSE(session.refuse(0.0));
  CHECK_FALSE(session.tick(1e9));
  session.start(0.0);
  std::vector<Pose> goals{session.goal()->world_T_optical};
  REQUIRE(session.refuse(1.0));
  REQUIRE(session.goal());
  goals.push_back(session.goal()->world_T_optical);
  CHECK_FALSE(session.tick(60.9));  // a minute after it was asked for
  CHECK(session.tick(61.1));
  REQUIRE(session.goal());
  goals.push_back(session.goal()->world_T_optical);
  CHECK(session.refused() == 2);
  CHECK(session.goals() == 3);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < i; ++j) CHECK((goals[i].matrix() - goals[j].matrix()).norm() > 1e-3);
}

TEST_CASE("three views in a row that cannot be taken stop the scan with the last cause") {
  ScanSession session(cell(), few_views());
  session.start(0.0);
  REQUIRE(session.tick(61.0));
  CHECK(session.status() == "moving, 0 views, 1 refused (no depth image and no point cloud came)");
  session.note("the lens is covered", 120.0);
  REQUIRE(session.tick(122.0));
  CHECK(session.missed_for() == "the lens is covered");
  session.refuse(123.0);  // the caller's own reasons are not told
  CHECK(session.status() == "moving, 0 views, 3 refused");
  session.note("the lens is covered", 124.0);
  const Pose third = session.goal()->world_T_optical;
  REQUIRE(session.tick(184.0));
  CHECK(session.state() == SessionState::paused);
  CHECK(session.missed_for() == "no frame came for 60 s; before, the lens is covered");
  CHECK_FALSE(session.tick(1e9));
  // It is asked for once more, with new patience.
  session.start(200.0);
  CHECK((session.goal()->world_T_optical.matrix() - third.matrix()).norm() < 1e-12);
  CHECK(session.missed() == 0);
  session.tick(261.0);
  session.tick(322.0);
  CHECK(session.missed() == 2);
  const Pose pose = session.goal()->world_T_optical;
  session.observe(look(pose), pose, 330.0);
  CHECK(session.missed() == 0);
  CHECK(session.status() == "moving, 1 views, 6 refused");
}

TEST_CASE("what was seen outlives a stop, not a reset") {
  ScanSession session(cell(), few_views());
  CHECK_FALSE(session.stop());
  session.start(0.0);
  const Pose pose = session.goal()->world_T_optical;
  session.observe(look(pose), pose, 1.0);
  REQUIRE(session.stop());
  CHECK_FALSE(session.stop());
  CHECK_FALSE(session.goal());
  CHECK_FALSE(session.objection(9.0, pose, pose).empty());
  CHECK(session.pipeline().views().size() == 1);
  REQUIRE(session.start(2.0));
  CHECK(session.state() == SessionState::moving);
  CHECK(session.pipeline().views().size() == 1);
  session.reset();
  CHECK(session.state() == SessionState::idle);
  CHECK(session.pipeline().views().empty());
}

TEST_CASE("session parameters are checked") {
  robot::SessionParameters p;
  p.settle = 0.0;
  CHECK_THROWS_WITH(ScanSession(cell(), {}, p), "arrival.settle must be positive, got 0");
  p = {};
  p.still_angle = std::nan("");
  CHECK_THROWS_AS(ScanSession(cell(), {}, p), ParameterError);
}

TEST_CASE("parameters are looked up by the names of the YAML files") {
  using Value = std::variant<bool, int, double, std::string>;
  const auto read = [](const std::map<std::string, Value>& server, const char* separator,
                       std::set<std::string>& known) {
    const auto lookup = [&](const std::string& name, auto& field) {
      const auto found = server.find(name);
      if (found == server.end()) return;
      using T = std::remove_reference_t<decltype(field)>;
      const auto* value = std::get_if<T>(&found->second);
      if (!value) throw ParameterError(name + " has another type");
      field = *value;
    };
    return robot::read_parameters(lookup, separator, known);
  };
  std::set<std::string> known;
  Parameters p = read(
      {{"max_views", 7}, {"split/bodies/radius_min", 0.01}, {"register_views", false}, {"planner", std::string("see")}},
      "/", known);
  CHECK(p.max_views == 7);
  CHECK(p.split.bodies.radius_min == 0.01);
  CHECK_FALSE(p.register_views);
  CHECK(p.planner == "see");
  CHECK(p.sor.mean_k == Parameters().sor.mean_k);
  CHECK(known.count("split/bodies/radius_min") == 1);
  CHECK(known.count("icp/max_distance") == 1);
  CHECK(known.count("split.bodies.radius_min") == 0);
  p = read({{"preset", std::string("paper")}, {"see.max_updates", 9}}, ".", known);
  CHECK(p.see.max_updates == 9);
  CHECK_FALSE(p.fuse_surfaces);
  CHECK(p.max_views == Parameters::paper().max_views);
  CHECK_THROWS_AS(read({{"preset", std::string("other")}}, "/", known), ParameterError);
  CHECK_THROWS_AS(read({{"max_views", 0}}, "/", known), ParameterError);
  CHECK_THROWS_WITH(read({{"normals/radius", std::nan("")}}, "/", known),
                    "normals/radius must be a finite number, got nan");
  CHECK_THROWS_WITH(read({{"gain.expected.voxel", 0.0}}, ".", known), "gain.expected.voxel must be positive, got 0");
  CHECK_THROWS_WITH(read({{"icp/kernel", std::string("soft")}}, "/", known), test::says("icp/kernel: "));
  CHECK_THROWS_WITH(read({{"max_views", std::string("many")}}, "/", known), test::says("max_views"));
}

TEST_CASE("joints are found by name") {
  struct State {
    std::vector<std::string> name;
    std::vector<double> position;
  } state;
  CHECK_FALSE(robot::joints_of(state));
  state.name = {"gripper",     "wrist_3_joint",       "wrist_2_joint",     "wrist_1_joint",
                "elbow_joint", "shoulder_lift_joint", "shoulder_pan_joint"};
  state.position = {9, 6, 5, 4, 3, 2, 1};
  REQUIRE(robot::joints_of(state));
  CHECK((*robot::joints_of(state) == (Joints() << 1, 2, 3, 4, 5, 6).finished()));
  state.position.pop_back();
  CHECK_FALSE(robot::joints_of(state));
  state.name = robot::joint_names("left_");
  CHECK(state.name.front() == "left_shoulder_pan_joint");
  CHECK_FALSE(robot::joints_of(state));
  CHECK_FALSE(robot::joints_of(state, "right_"));
  REQUIRE(robot::joints_of(state, "left_"));
  CHECK((*robot::joints_of(state, "left_"))[0] == 9.0);
}

TEST_CASE("the poses that a result is published as are where a gripper takes the fruit") {
  Fruit fitted, plain;
  fitted.centroid = plain.centroid = {0.1, 0.5, 0.2};
  fitted.body.emplace();
  fitted.body->center = {0.1, 0.52, 0.2};
  const robot::ResultPoses poses = robot::result_poses({fitted, plain});
  REQUIRE(poses.fruits.size() == 2);
  CHECK(poses.fruits[0].translation() == fitted.body->center);
  CHECK(poses.fruits[1].translation() == plain.centroid);
}
