// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/scene.hpp>

#include "io/io_support.hpp"
#include "support/says.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace scene_test {

namespace {

const auto reader = [](const std::filesystem::path& path) { io::read_scene(path); };

Mesh tetrahedron(float scale = 0.05f) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {0, 0, scale}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

const std::string kRobot = "robot:\n  base: {xyz: [0, 0, 0], rpy: [0, 0, 0]}\n";
const std::string kVolume = "scan_volume: {min: [-0.1, 0.4, 0], max: [0.1, 0.6, 0.3]}\n";
const std::string kObjects = "objects:\n  - {id: 1, class: fruit, mesh: fruit.stl}\n";
const std::string kScene = "name: small\n" + kRobot + kVolume + kObjects;

/// A folder with a mesh in it.
struct SceneFolder : TempFolder {
  SceneFolder() { io::write_stl(*this / "fruit.stl", tetrahedron()); }
  io::SceneFile read(const std::string& yaml) const { return io::read_scene(file("scene.yaml", yaml)); }
  void refuse(const std::string& yaml, const std::string& what) const {
    INFO(yaml);
    require_file_error(file("scene.yaml", yaml), what, reader);
  }
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

}  // namespace

TEST_CASE("a scene with nothing optional has the documented defaults") {
  const SceneFolder folder;
  const io::SceneFile file = folder.read(kScene);
  const Workcell& cell = file.workcell;
  CHECK(cell.name == "small");
  CHECK(cell.world_T_base.isApprox(Pose::Identity()));
  CHECK(cell.tool0_T_optical.translation() == Eigen::Vector3d(0, 0, 0.03));
  CHECK(cell.tool0_T_optical.linear().isIdentity());
  CHECK(cell.start == (Joints() << 0, -1.57, 1.57, -1.57, -1.57, 0).finished());
  const sensor::Intrinsics wanted = sensor::intrinsics_from_fov(1024, 768, deg(70), deg(55));
  CHECK(cell.sensor.intrinsics.width == 1024);
  CHECK(cell.sensor.intrinsics.height == 768);
  CHECK(cell.sensor.intrinsics.fx == wanted.fx);
  CHECK(cell.sensor.range_min == 0.25);
  CHECK(cell.sensor.range_max == 9.0);
  CHECK(cell.scan_volume.min == Eigen::Vector3d(-0.1, 0.4, 0));
  CHECK(cell.scan_volume.max == Eigen::Vector3d(0.1, 0.6, 0.3));
  CHECK(cell.keep_out.empty());
  REQUIRE(file.scene.objects.size() == 1);
  CHECK(file.scene.objects[0].id == 1);
  CHECK(file.scene.objects[0].cls == study::ObjectClass::fruit);
  CHECK(file.scene.objects[0].mesh.triangles.size() == 4);
  CHECK(folder.read(replaced(kScene, kObjects, "objects: []\n")).scene.objects.empty());
}

TEST_CASE("every key of a scene arrives where it belongs") {
  const SceneFolder folder;
  const io::SceneFile file = folder.read(R"(name: "full: one"
robot:
  base: {xyz: [0.1, 0.2, 0.3], rpy: [0.1, -0.2, 0.3]}
  tool: {xyz: [0, 0.01, 0.05], rpy: [0, 0, 1.57]}
  start: [0.1, -1, 1, -1, -1, 0.5]
sensor: {model: l515, width: 640, height: 480, fov_deg: [60, 46], range: [0.2, 3]}
scan_volume: {min: [-0.17, 0.40, -0.02], max: [0.17, 0.72, 0.42]}
keep_out:
  - {name: platform, box: {center: [0, -0.1, -0.06], size: [0.7, 0.7, 0.1]}}
  - {name: cluster,  cylinder: {center: [0.015, 0.545, 0.21], radius: 0.35, height: 0.9}}
objects:
  - {id: 7, class: fruit, mesh: fruit.stl, xyz: [0.05, 0.55, 0.13], rpy: [0.1, 0.2, 0.4], scale: 2.0}
  - {id: 0, class: stem, mesh: fruit.stl}
  - {id: 0, class: leaf, mesh: fruit.stl, scale: 0.5}
  - {id: 0, class: other, material: leaf, mesh: fruit.stl, xyz: [1, 0, 0]}
)");
  const Workcell& cell = file.workcell;
  CHECK(cell.name == "full: one");
  CHECK(cell.world_T_base.isApprox(pose_from_xyz_rpy({0.1, 0.2, 0.3}, {0.1, -0.2, 0.3})));
  CHECK(cell.tool0_T_optical.isApprox(pose_from_xyz_rpy({0, 0.01, 0.05}, {0, 0, 1.57})));
  CHECK(cell.start == (Joints() << 0.1, -1, 1, -1, -1, 0.5).finished());
  CHECK(cell.sensor.intrinsics.fx == sensor::intrinsics_from_fov(640, 480, deg(60), deg(46)).fx);
  CHECK(cell.sensor.range_min == 0.2);
  REQUIRE(cell.keep_out.size() == 2);
  CHECK(cell.keep_out[0].name == "platform");
  CHECK(std::get<Box>(cell.keep_out[0].shape).size == Eigen::Vector3d(0.7, 0.7, 0.1));
  CHECK(std::get<Cylinder>(cell.keep_out[1].shape).radius == 0.35);
  CHECK(std::get<Cylinder>(cell.keep_out[1].shape).height == 0.9);
  REQUIRE(file.scene.objects.size() == 4);
  const Mesh wanted = transformed(tetrahedron(), pose_from_xyz_rpy({0.05, 0.55, 0.13}, {0.1, 0.2, 0.4}), 2.0);
  CHECK(volume(file.scene.objects[0].mesh) == Approx(volume(wanted)));
  CHECK(area(file.scene.objects[2].mesh) == Approx(0.25 * area(tetrahedron())));
  CHECK(file.scene.objects[3].mesh.vertices[0].x() >= 1.0f);
  CHECK(file.scene.objects[1].cls == study::ObjectClass::stem);
  CHECK(file.scene.objects[2].cls == study::ObjectClass::leaf);
  CHECK(file.scene.objects[3].cls == study::ObjectClass::other);
  CHECK(file.scene.objects[3].material == study::ObjectClass::leaf);
  CHECK_FALSE(file.scene.objects[2].material);
}

TEST_CASE("objects have a ripeness and a color where the scene says so") {
  const SceneFolder folder;
  const auto with = [&](const std::string& keys) {
    return folder.read(replaced(kScene, "mesh: fruit.stl", keys + ", mesh: fruit.stl")).scene.objects.front();
  };
  CHECK(with("ripeness: 0.4").ripeness == 0.4);
  CHECK(with("ripeness: green").ripeness == 0.0);
  CHECK(with("ripeness: pink").ripeness.value() == Approx(0.45));
  CHECK(with("color: [250, 0, 7]").color == Rgb{250, 0, 7});
  CHECK_FALSE(folder.read(kScene).scene.objects.front().ripeness);
  CHECK_FALSE(folder.read(kScene).scene.objects.front().color);
}

TEST_CASE("a text is read as the file that it stands for") {
  const SceneFolder folder;
  const io::SceneFile file = io::scene_from_yaml(kScene, folder / "absent.yaml");
  CHECK(file.workcell.name == "small");
  REQUIRE(file.scene.objects.size() == 1);
  CHECK(file.scene.objects[0].mesh.triangles.size() == 4);
  CHECK_THROWS_WITH(io::scene_from_yaml("name: small\n", "cell"), test::says("cell"));
}

TEST_CASE("scenes round trip") {
  const SceneFolder folder;
  io::SceneFile file = folder.read(kScene);
  file.workcell.name = "it's \"quoted\": yes\n";
  file.workcell.world_T_base = pose_from_xyz_rpy({0.1, 1.0 / 3.0, -0.3}, {0.5, -0.6, 2.7});
  file.workcell.tool0_T_optical = pose_from_xyz_rpy({0, 0, 0.03}, {0.2, kPi / 2, -0.4});  // at the singularity
  file.workcell.start[2] = 0.1 + 0.2;
  file.workcell.arm = arm::ur_model("ur5e");
  file.workcell.sensor.intrinsics = sensor::intrinsics_from_fov(320, 200, deg(69.5), deg(41));
  file.workcell.keep_out = {{"null", Box{{0, 1, 2}, {0.1, 0.2, 0.3}}}, {"pot 1", Cylinder{{3, 2, 1}, 0.25, 0.5}}};
  file.scene.objects.push_back({0, study::ObjectClass::leaf, tetrahedron(0.02f)});
  file.scene.objects.push_back({0, study::ObjectClass::leaf, tetrahedron(0.03f), study::ObjectClass::stem});
  file.scene.objects.push_back({12, study::ObjectClass::fruit, tetrahedron(0.04f)});
  file.scene.objects.back().ripeness = 1.0 / 3.0;
  file.scene.objects.back().color = Rgb{1, 20, 255};
  io::write_scene(folder / "out.yaml", file);
  for (const char* mesh : {"fruit_1.stl", "fruit_12.stl", "leaf_1.stl", "leaf_2.stl"})
    CHECK(std::filesystem::exists(folder / mesh));
  const io::SceneFile back = io::read_scene(folder / "out.yaml");
  CHECK(back.workcell.name == file.workcell.name);
  CHECK((back.workcell.world_T_base.matrix() - file.workcell.world_T_base.matrix()).norm() < 1e-14);
  CHECK((back.workcell.tool0_T_optical.matrix() - file.workcell.tool0_T_optical.matrix()).norm() < 1e-14);
  CHECK(back.workcell.start == file.workcell.start);
  CHECK(back.workcell.arm.name == "ur5e");
  CHECK(back.workcell.sensor.intrinsics.fx == Approx(file.workcell.sensor.intrinsics.fx).epsilon(1e-9));
  CHECK(back.workcell.sensor.intrinsics.fy == Approx(file.workcell.sensor.intrinsics.fy).epsilon(1e-9));
  CHECK(back.workcell.scan_volume.min == file.workcell.scan_volume.min);
  REQUIRE(back.workcell.keep_out.size() == 2);
  CHECK(back.workcell.keep_out[0].name == "null");
  CHECK(std::get<Box>(back.workcell.keep_out[0].shape).center == Eigen::Vector3d(0, 1, 2));
  CHECK(std::get<Cylinder>(back.workcell.keep_out[1].shape).radius == 0.25);
  REQUIRE(back.scene.objects.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(back.scene.objects[i].id == file.scene.objects[i].id);
    CHECK(back.scene.objects[i].cls == file.scene.objects[i].cls);
    CHECK(back.scene.objects[i].material == file.scene.objects[i].material);
    CHECK(back.scene.objects[i].ripeness == file.scene.objects[i].ripeness);
    CHECK(back.scene.objects[i].color == file.scene.objects[i].color);
    CHECK(volume(back.scene.objects[i].mesh) == Approx(volume(file.scene.objects[i].mesh)));
  }
  file.workcell.tool0_T_optical = pose_from_xyz_rpy({0, 0, 0.03}, {0.2, -1.3, 0.4});
  io::write_scene(folder / "out.yaml", file);
  io::write_scene(folder / "again.yaml", io::read_scene(folder / "out.yaml"));
  CHECK(slurp(folder / "again.yaml") == slurp(folder / "out.yaml"));
}

TEST_CASE("unknown, missing and repeated keys are named with file and line") {
  const SceneFolder folder;
  folder.refuse(kScene + "color: red\n", ":7: unknown key 'color'");
  folder.refuse(kScene + "name: again\n", "key 'name' twice");
  folder.refuse(replaced(kScene, "rpy: [0, 0, 0]}", "rpy: [0, 0, 0], yaw: 3}"), ":3: robot.base: unknown key 'yaw'");
  folder.refuse(replaced(kScene, "mesh: fruit.stl", "mesh: fruit.stl, hue: 3"), ":6: objects[0]: unknown key 'hue'");
  folder.refuse(kScene + "sensor: {model: l515, fps: 30}\n", "sensor: unknown key 'fps'");
  folder.refuse(kScene + "keep_out: [{name: a, box: {center: [0, 0, 0], size: [1, 1, 1], yaw: 1}}]\n",
                "keep_out[0].box: unknown key 'yaw'");
  folder.refuse(replaced(kScene, "name: small\n", ""), "missing key 'name'");
  folder.refuse(replaced(kScene, kRobot, ""), "missing key 'robot'");
  folder.refuse(replaced(kScene, kRobot, "robot: {start: [0, 0, 0, 0, 0, 0]}\n"), "robot: missing key 'base'");
  folder.refuse(replaced(kScene, kVolume, ""), "missing key 'scan_volume'");
  folder.refuse(replaced(kScene, "min: [-0.1, 0.4, 0], ", ""), "scan_volume: missing key 'min'");
  folder.refuse(replaced(kScene, kObjects, ""), "missing key 'objects'");
  folder.refuse(replaced(kScene, "id: 1, ", ""), "objects[0]: missing key 'id'");
  folder.refuse(replaced(kScene, "class: fruit, ", ""), "objects[0]: missing key 'class'");
  folder.refuse(replaced(kScene, ", mesh: fruit.stl", ""), "objects[0]: missing key 'mesh'");
  folder.refuse(kScene + "keep_out: [{box: {center: [0, 0, 0], size: [1, 1, 1]}}]\n",
                "keep_out[0]: missing key 'name'");
}

TEST_CASE("values out of range are named") {
  const SceneFolder folder;
  const auto refuse = [&](const std::string& what, const std::string& by, const std::string& error) {
    folder.refuse(replaced(kScene, what, by), error);
  };
  refuse("id: 1", "id: 0", "objects[0].id: the id of a fruit must be from 1 to 1000000, got 0");
  refuse("id: 1", "id: -2", "objects[0].id");
  refuse("id: 1", "id: 1.5", "'1.5' is not a whole number");
  refuse("class: fruit", "class: stem", "objects[0].id: must be 0 for objects other than fruit, got 1");
  refuse("class: fruit", "class: apple", "objects[0].class: must be fruit, stem, leaf or other, got 'apple'");
  refuse("mesh: fruit.stl", "mesh: none.stl", "objects[0].mesh: " + (folder / "none.stl").string() + ": no such file");
  refuse("mesh: fruit.stl", "mesh: scene.yaml", "objects[0].mesh: ");
  refuse("mesh: fruit.stl", "mesh: fruit.stl, scale: 0", "objects[0].scale: must be positive, got 0");
  refuse("mesh: fruit.stl", "mesh: fruit.stl, xyz: [1, 2]", "objects[0].xyz: expected a list of 3 numbers");
  refuse("mesh: fruit.stl", "mesh: fruit.stl, xyz: [1, 2, three]", "objects[0].xyz[2]: 'three' is not a number");
  refuse("mesh: fruit.stl", "mesh: fruit.stl, xyz: [1, 2, nan]", "must be finite");
  refuse("mesh: fruit.stl", "mesh: fruit.stl, ripeness: 1.5", "objects[0].ripeness: must be from 0 to 1, or green");
  refuse("mesh: fruit.stl", "mesh: fruit.stl, ripeness: rosy", "objects[0].ripeness: must be a share from 0 to 1, or");
  refuse("mesh: fruit.stl", "mesh: fruit.stl, color: [1, 2]", "objects[0].color: expected red, green and blue");
  refuse("mesh: fruit.stl", "mesh: fruit.stl, color: [1, 2, 256]", "objects[0].color[2]: must be from 0 to 255");
  refuse("mesh: fruit.stl", "mesh: [fruit.stl]", "objects[0].mesh: expected a text");
  refuse("max: [0.1, 0.6, 0.3]", "max: [0.1, 0.4, 0.3]", "scan_volume: min must be below max, but along y");
  refuse("max: [0.1, 0.6, 0.3]", "max: [0.1, 0.6, -3]", "along z");
  refuse("name: small", "name: []", "name: expected a text");
  refuse(kObjects, "objects: 3\n", "objects: expected a list");
  refuse(kObjects, "objects: [3]\n", "objects[0]: expected keys and values");
  refuse(kRobot, kRobot + "  start: [0, 0, 0]\n", "robot.start: expected a list of 6 numbers");
  folder.refuse(kScene + "  - {id: 1, class: fruit, mesh: fruit.stl}\n", ":7: objects[1].id: two fruits have the id 1");
  folder.refuse(kScene + "sensor: {model: kinect}\n",
                "sensor.model: 'kinect' is not known (known are l515, d405, azure; any other camera");
  folder.refuse(kScene + "sensor: kinect\n",
                "sensor: 'kinect' is not known (known are l515, d405, azure; any other camera");
  folder.refuse(kScene + "sensor: D405\n", "; did you mean 'd405'?");
  folder.refuse(kScene + "sensor: [l515]\n", "sensor: expected keys and values");
  folder.refuse(kScene + "sensor:\n", "sensor: is empty: expected keys and values");
  folder.refuse(kScene + "sensor: {width: 0}\n", "sensor.width");
  folder.refuse(kScene + "sensor: {height: 1000000}\n", "sensor.height");
  folder.refuse(kScene + "sensor: {fov_deg: [70, 180]}\n", "sensor.fov_deg");
  folder.refuse(kScene + "sensor: {fov_deg: [1.22, 0.96]}\n",
                "sensor.fov_deg: an opening angle of 0.96 degrees is too small for a depth camera: is it in radians?");
  folder.refuse(kScene + "sensor: {range: [2, 1]}\n", "sensor.range");
  folder.refuse(kScene + "keep_out: [{name: a}]\n", "keep_out[0]: expected one of 'box' and 'cylinder'");
  folder.refuse(kScene + "keep_out: [{name: a, box: {center: [0, 0, 0], size: [1, 0, 1]}}]\n", "keep_out[0].box.size");
  folder.refuse(kScene + "keep_out: [{name: a, cylinder: {center: [0, 0, 0], radius: -1, height: 1}}]\n",
                "keep_out[0].cylinder.radius: must be positive, got -1");
}

TEST_CASE("any pinhole camera can be described, by name, opening angles or focal lengths") {
  const SceneFolder folder;
  const auto camera = [&](const std::string& sensor) {
    return folder.read(kScene + "sensor: " + sensor + "\n").workcell.sensor;
  };
  const sensor::DepthCamera d405 = camera("{model: d405}");
  CHECK(d405.intrinsics.width == 1280);
  CHECK(d405.intrinsics.fx == sensor::intrinsics_from_fov(1280, 720, deg(84), deg(58)).fx);
  CHECK(d405.range_min == 0.1);
  CHECK(d405.range_max == 0.5);
  CHECK(d405.housing_radius == 0.03);
  const sensor::DepthCamera small = camera("{model: d405, width: 640, height: 360, range: [0.06, 0.4]}");
  CHECK(small.intrinsics.fx == Approx(0.5 * d405.intrinsics.fx));
  CHECK(small.range_min == 0.06);
  CHECK(camera("{model: azure}").intrinsics.height == 576);
  CHECK(camera("{model: azure_kinect}").intrinsics.fx == camera("azure").intrinsics.fx);
  CHECK(camera("d405").intrinsics.fx == d405.intrinsics.fx);
  CHECK(camera("d405").range_max == 0.5);
  const auto doubts = [&](const std::string& sensor) {
    return folder.read(kScene + "sensor: " + sensor + "\n").warnings;
  };
  CHECK(doubts("{model: d405, range: [0.07, 0.8]}").empty());
  CHECK(doubts("{range: [0.01, 100]}").empty());
  REQUIRE(doubts("{model: d405, range: [0.25, 9]}").size() == 1);
  CHECK_THAT(doubts("{model: d405, range: [0.25, 9]}")[0],
             test::says("sensor.range: 0.25 to 9 m is not what the d405 measures, 0.1 to 0.5 m"));
  const sensor::DepthCamera own = camera(
      "{width: 848, height: 480, fx: 421.5, fy: 422.25, cx: 430.125, cy: 238, range: [0.07, 2], "
      "housing: {radius: 0.05, depth: 0.03}}");
  CHECK(own.intrinsics.width == 848);
  CHECK(own.intrinsics.fx == 421.5);
  CHECK(own.intrinsics.fy == 422.25);
  CHECK(own.intrinsics.cx == 430.125);
  CHECK(own.intrinsics.cy == 238.0);
  CHECK(own.housing_radius == 0.05);
  CHECK(camera("{width: 100, height: 80, fx: 90, fy: 90}").intrinsics.cx == 49.5);
  // It is written as it was read.
  io::SceneFile file = folder.read(kScene);
  file.workcell.sensor = own;
  file.workcell.tool0_T_tool = pose_from_xyz_rpy({0.05, 0, 0.12}, {0, 0.3, 0});
  io::write_scene(folder / "out.yaml", file);
  const Workcell back = io::read_scene(folder / "out.yaml").workcell;
  CHECK(back.sensor.intrinsics.fx == 421.5);
  CHECK(back.sensor.intrinsics.cx == 430.125);
  CHECK(back.sensor.housing_depth == 0.03);
  REQUIRE(back.tool0_T_tool);
  CHECK(back.tool0_T_tool->isApprox(*file.workcell.tool0_T_tool, 1e-12));
  CHECK_FALSE(folder.read(kScene).workcell.tool0_T_tool);
  folder.refuse(kScene + "sensor: {fx: 400, fy: 400}\n", "sensor: 'fx' and 'fy' are in pixels, so 'width'");
  folder.refuse(kScene + "sensor: {width: 10, height: 10, fx: 400}\n", "sensor: missing key 'fy'");
  folder.refuse(kScene + "sensor: {width: 10, height: 10, fx: 0, fy: 1}\n", "sensor.fx: must be positive, got 0");
  folder.refuse(kScene + "sensor: {width: 10, height: 10, fx: 9, fy: 9, fov_deg: [9, 9]}\n",
                "expected either 'fov_deg'");
}

TEST_CASE("a pose may be given by angles, a quaternion or a matrix") {
  const SceneFolder folder;
  const auto tool = [&](const std::string& pose) {
    return folder.read(replaced(kScene, kRobot, kRobot + "  tool: " + pose + "\n"));
  };
  const Pose wanted = pose_from_xyz_rpy({0.01, 0.02, 0.05}, {0.0, 0.0, deg(30)});
  for (const char* pose : {"{xyz: [0.01, 0.02, 0.05], rpy: [0, 0, 0.5235987755982988]}",
                           "{xyz: [0.01, 0.02, 0.05], quaternion: [0, 0, 0.2588190451025207, 0.9659258262890683]}",
                           "{matrix: [[0.8660254037844387, -0.5, 0, 0.01], [0.5, 0.8660254037844387, 0, 0.02], "
                           "[0, 0, 1, 0.05], [0, 0, 0, 1]]}",
                           "{matrix: [0.8660254037844387, -0.5, 0, 0.01, 0.5, 0.8660254037844387, 0, 0.02, "
                           "0, 0, 1, 0.05, 0, 0, 0, 1]}"}) {
    const io::SceneFile file = tool(pose);
    CHECK(file.workcell.tool0_T_optical.isApprox(wanted, 1e-12));
    CHECK(file.warnings.empty());
  }
  const io::SceneFile rounded = tool("{matrix: [[0.866, -0.5, 0, 0.01], [0.5, 0.866, 0, 0.02], [0, 0, 1, 0.05]]}");
  CHECK(is_rigid(rounded.workcell.tool0_T_optical));
  CHECK(rounded.workcell.tool0_T_optical.isApprox(wanted, 1e-4));
  REQUIRE(rounded.warnings.size() == 1);
  CHECK(rounded.warnings[0].find("robot.tool: its rotation matrix was off by ") == 0);
  const auto refuse = [&](const std::string& pose, const std::string& error) {
    folder.refuse(replaced(kScene, kRobot, kRobot + "  tool: " + pose + "\n"), error);
  };
  refuse("{matrix: [[0.8, -0.5, 0, 0], [0.5, 0.8, 0, 0], [0, 0, 1, 0]]}",
         ":4: robot.tool: is not a rigid transform: its rotation matrix is off by 0.048");
  refuse("{matrix: [1, 0, 0]}", "robot.tool.matrix[0]: expected a list");
  refuse("{matrix: [1, 0]}", "robot.tool.matrix: expected four rows of four numbers");
  refuse("{xyz: [0, 0, 0], matrix: [1, 0]}", "robot.tool: expected either 'matrix', or");
  refuse("{xyz: [0, 0, 0], rpy: [0, 0, 0], quaternion: [0, 0, 0, 1]}", "expected one of 'rpy' and 'quaternion'");
  refuse("{xyz: [0, 0, 0], quaternion: [0, 0, 0, 2]}", "the length of its quaternion is off by 1");
  refuse("{xyz: [0, 0, 0]}", "robot.tool: missing key 'rpy'");
}

TEST_CASE("degrees and millimetres in a scene are refused, and the likely cause is named") {
  const SceneFolder folder;
  folder.refuse(replaced(kScene, "rpy: [0, 0, 0]", "rpy: [0, 0, 180]"),
                ":3: robot.base.rpy: an angle of 180 rad is more than a full turn: are the angles in degrees?");
  folder.refuse(
      replaced(kScene, kRobot, kRobot + "  start: [0, -90, 90, -90, -90, 0]\n"),
      ":4: robot.start: joint 2 is -90 rad, outside of its limits, -6.283 to 6.283: are the angles in degrees?");
  folder.refuse(replaced(kScene, kRobot, kRobot + "  start: [0, -1.57, 3.5, 0, 0, 0]\n"),
                "robot.start: joint 3 is 3.5 rad, outside of its limits, -3.142 to 3.142");
  folder.refuse(replaced(kScene, kRobot, kRobot + "  tool: {xyz: [0, 0, 30], rpy: [0, 0, 0]}\n"),
                "robot.tool: the camera is 30 m from the flange: is it in millimetres?");
  folder.refuse(replaced(kScene, kRobot, kRobot + "  gripper: {xyz: [0, 0, 150], rpy: [0, 0, 0]}\n"),
                "robot.gripper: the gripping point is 150 m from the flange: is it in millimetres?");
  folder.refuse(replaced(kScene, kVolume, "scan_volume: {min: [-100, 400, 0], max: [100, 600, 300]}\n"),
                "scan_volume: is 300 m long: is it in millimetres?");
  folder.refuse(replaced(kScene, "mesh: fruit.stl", "mesh: fruit.stl, scale: 1000"),
                ":6: objects[0].mesh: a fruit 50 m across: is the mesh in millimetres? Then give scale: 0.001");
  folder.refuse(replaced(kScene, "mesh: fruit.stl", "mesh: fruit.stl, scale: 0.001"), "does its scale fit the mesh?");
  folder.refuse(kScene + "sensor: {range: [250, 9000]}\n", "sensor.range: begins at 250 m: is it in millimetres?");
}

TEST_CASE("what is no scene at all is refused") {
  const SceneFolder folder;
  require_file_error(folder / "none.yaml", "no such file", reader);
  require_file_error(folder.path(), "directory", reader);
  folder.refuse("", "empty");
  folder.refuse("# nothing\n", "empty");
  folder.refuse("just text\n", "expected keys and values");
  folder.refuse("[1, 2]\n", "expected keys and values");
  folder.refuse("name: {\n", "not YAML");
  folder.refuse("name: a\n---\nname: b\n", "more than one");
  folder.refuse(",", "more than one");
  folder.refuse(std::string("name: \0\1\2\n", 10), "");
  survive_damage(folder, "scene.yaml", kScene, reader);
}

TEST_CASE("a relative mesh path stays in the scene's folder, an absolute one may be anywhere") {
  const SceneFolder folder;
  for (const char* path : {"../fruit.stl", "a/../../fruit.stl", "./../fruit.stl", ".."})
    folder.refuse(replaced(kScene, "mesh: fruit.stl", std::string("mesh: ") + path), "leaves the scene's folder");
  for (const std::string& path :
       {std::string("./fruit.stl"), std::string("a/../fruit.stl"), (folder / "fruit.stl").string()}) {
    std::filesystem::create_directory(folder / "a");
    CHECK(folder.read(replaced(kScene, "mesh: fruit.stl", "mesh: " + path)).scene.objects.size() == 1);
  }
}

TEST_CASE("YAML that nests without end is refused") {
  const SceneFolder folder;
  for (const std::string& deep :
       {std::string(100000, '['), std::string(100000, '{'), "a: " + std::string(100, '['), std::string(3000, '-'), [] {
          std::string text;
          for (int i = 0; i < 20000; ++i) text += "- ";
          return text;
        }()})
    folder.refuse(deep, "");
}

TEST_CASE("scenes that the format cannot express are not written") {
  const SceneFolder folder;
  const io::SceneFile good = folder.read(kScene);
  const std::size_t files = folder.files();
  const auto refuse = [&](const char* what, auto&& spoil) {
    io::SceneFile bad = good;
    spoil(bad);
    INFO(what);
    CHECK_THROWS_AS(io::write_scene(folder / "out.yaml", bad), InputError);
    CHECK_FALSE(std::filesystem::exists(folder / "out.yaml"));
  };
  refuse("fruit without id", [](auto& f) { f.scene.objects[0].id = 0; });
  refuse("stem with id", [](auto& f) { f.scene.objects[0].cls = study::ObjectClass::stem; });
  refuse("two ids", [](auto& f) { f.scene.objects.push_back(f.scene.objects[0]); });
  refuse("no mesh", [](auto& f) { f.scene.objects[0].mesh = {}; });
  refuse("empty volume", [](auto& f) { f.workcell.scan_volume = Aabb(); });
  refuse("no name", [](auto& f) { f.workcell.name.clear(); });
  refuse("camera without intrinsics", [](auto& f) { f.workcell.sensor = sensor::DepthCamera(); });
  refuse("pose that scales", [](auto& f) { f.workcell.world_T_base.linear() *= 2.0; });
  refuse("no number", [](auto& f) { f.workcell.start[0] = std::nan(""); });
  CHECK(folder.files() == files);
  CHECK_THROWS_AS(io::write_scene(folder / "no/such/folder.yaml", good), FileError);
}

}  // namespace scene_test
