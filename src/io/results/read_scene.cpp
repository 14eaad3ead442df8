// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/rigid_pose.hpp>
#include <agrisee/geometry/aabb.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/true_ripeness.hpp>

#include <cctype>
#include <map>
#include <set>

#include "io/formats/text.hpp"
#include "io/formats/yaml_camera.hpp"
#include "io/formats/yaml_map.hpp"
#include "io/formats/yaml_pose.hpp"

namespace agrisee::io {
namespace {

namespace fs = std::filesystem;

void read_robot(const YamlValue& robot, Workcell& cell, std::vector<std::string>& warnings) {
  robot.check_keys({"arm", "base", "tool", "gripper", "start"});
  if (robot.has("arm")) {
    const YamlValue name = robot.at("arm");
    try {
      cell.arm = arm::ur_model(name.text());
    } catch (const InputError& error) {
      name.fail(error.what());
    }
  }
  cell.world_T_base = read_pose(robot.at("base"), warnings);
  if (robot.has("tool")) cell.tool0_T_optical = read_pose(robot.at("tool"), warnings);
  if (robot.has("gripper")) cell.tool0_T_tool = read_pose(robot.at("gripper"), warnings);
  if (robot.has("start")) cell.start = robot.at("start").numbers<6>();
  if (const std::string fault = cell.arm.limits.complaint(cell.start); !fault.empty())
    (robot.has("start") ? robot.at("start") : robot).fail(fault);
  if (const auto fault = fault_of_hand_eye(cell)) robot.at("tool").fail(*fault);
  if (const auto fault = fault_of_gripper(cell)) robot.at("gripper").fail(*fault);
}

/// The published figures of a camera by its name.
const sensor::CameraModel& read_model(const YamlValue& value) {
  const std::string text = value.text(), name = text == "azure_kinect" ? "azure" : text;  // its name in older files
  std::string known;
  std::vector<std::string> names;
  for (const sensor::CameraModel& model : sensor::kCameraModels) {
    if (name == model.name) return model;
    names.emplace_back(model.name);
    known += (known.empty() ? "" : ", ") + names.back();
  }
  value.fail(excerpt(text) + " is not known (known are " + known +
             "; any other camera is described by fx, fy, cx, cy or fov_deg)" + did_you_mean(text, names));
}

/// A pinhole by its focal lengths, or by its opening angles.
sensor::Intrinsics read_intrinsics(const YamlValue& value, const sensor::CameraModel& model) {
  const int width = value.has("width") ? pixels(value.at("width")) : model.width;
  const int height = value.has("height") ? pixels(value.at("height")) : model.height;
  Eigen::Vector2d fov(model.fov_x_deg, model.fov_y_deg);
  if (value.has("fov_deg")) {
    fov = value.at("fov_deg").numbers<2>();
    if (!(fov.minCoeff() > 0.0 && fov.maxCoeff() < 180.0))
      value.at("fov_deg").fail("must be between 0 and 180 degrees");
    constexpr double kNarrowest = 5.0;  // degrees; no depth camera sees less, and 5 rad are no opening angle
    if (fov.minCoeff() < kNarrowest)
      value.at("fov_deg").fail("an opening angle of " + format(fov.minCoeff()) +
                               " degrees is too small for a depth camera: is it in radians? It has to be in degrees");
  }
  sensor::Intrinsics k = sensor::intrinsics_from_fov(width, height, deg(fov.x()), deg(fov.y()));
  if (!value.has("fx") && !value.has("fy") && !value.has("cx") && !value.has("cy")) return k;
  if (value.has("fov_deg")) value.fail("expected either 'fov_deg', or 'fx', 'fy', 'cx' and 'cy'");
  if (!value.has("width") || !value.has("height"))
    value.fail("'fx' and 'fy' are in pixels, so 'width' and 'height' of the image are needed, too");
  k.fx = positive(value.at("fx"));
  k.fy = positive(value.at("fy"));
  if (value.has("cx")) k.cx = value.at("cx").number();
  if (value.has("cy")) k.cy = value.at("cy").number();
  return k;
}

/// A camera by the name of its model alone, or by keys and values.
/// @param warnings receives doubt about a range that is not that of the model
void read_sensor(const YamlValue& value, sensor::DepthCamera& sensor, std::vector<std::string>& warnings) {
  if (value.is_text()) {
    sensor = read_model(value).camera();
    return;
  }
  value.check_keys({"model", "width", "height", "fov_deg", "fx", "fy", "cx", "cy", "range", "housing"});
  const sensor::CameraModel& model = value.has("model") ? read_model(value.at("model")) : sensor::kCameraModels[0];
  sensor = model.camera();
  sensor.intrinsics = read_intrinsics(value, model);
  if (value.has("range")) {
    const Eigen::Vector2d range = read_range(value.at("range"));
    sensor.range_min = range[0];
    sensor.range_max = range[1];
    constexpr double kTimes = 3.0;  // cameras see somewhat beyond their data sheets
    if (value.has("model") && (range[0] * kTimes < model.range_min || range[1] > kTimes * model.range_max))
      warnings.push_back(value.at("range").place() + ": " + format(range[0]) + " to " + format(range[1]) +
                         " m is not what the " + model.name + " measures, " + format(model.range_min) + " to " +
                         format(model.range_max) + " m; the keys beside 'model' replace its figures");
  }
  if (value.has("housing")) {
    const YamlValue housing = value.at("housing");
    housing.check_keys({"radius", "depth"});
    sensor.housing_radius = positive(housing.at("radius"));
    sensor.housing_depth = positive(housing.at("depth"));
  }
}

KeepOut read_keep_out(const YamlValue& value) {
  value.check_keys({"name", "box", "cylinder"});
  KeepOut solid;
  solid.name = value.at("name").text();
  if (value.has("box") == value.has("cylinder")) value.fail("expected one of 'box' and 'cylinder'");
  if (value.has("box")) {
    const YamlValue box = value.at("box");
    box.check_keys({"center", "size"});
    const Box shape{box.at("center").numbers<3>(), box.at("size").numbers<3>()};
    if (!(shape.size.minCoeff() > 0.0)) box.at("size").fail("must be positive");
    solid.shape = shape;
  } else {
    const YamlValue cylinder = value.at("cylinder");
    cylinder.check_keys({"center", "radius", "height"});
    solid.shape =
        Cylinder{cylinder.at("center").numbers<3>(), positive(cylinder.at("radius")), positive(cylinder.at("height"))};
  }
  return solid;
}

study::ObjectClass read_class(const YamlValue& value) {
  const std::string name = value.text();
  if (name == "fruit") return study::ObjectClass::fruit;
  if (name == "stem") return study::ObjectClass::stem;
  if (name == "leaf") return study::ObjectClass::leaf;
  if (name != "other") value.fail("must be fruit, stem, leaf or other, got " + excerpt(name));
  return study::ObjectClass::other;
}

/// The meshes of a scene; each file is read once.
class MeshCache {
 public:
  explicit MeshCache(fs::path folder) : folder_(std::move(folder)) {}
  /// The mesh whose path is `value`.
  const Mesh& get(const YamlValue& value) {
    const fs::path named = value.text();
    if (named.is_relative() && *named.lexically_normal().begin() == "..")
      value.fail(excerpt(value.text()) + " leaves the scene's folder; a mesh elsewhere needs an absolute path");
    const fs::path file = folder_ / named;
    const auto [entry, added] = meshes_.try_emplace(file.string());
    if (added) {
      try {
        entry->second = read_mesh(file);
      } catch (const FileError& e) {
        value.fail(e.what());
      }
    }
    return entry->second;
  }

 private:
  fs::path folder_;
  std::map<std::string, Mesh> meshes_;
};

/// How ripe a fruit is: a share, or the name of a class.
double read_ripeness(const YamlValue& value) {
  const std::string text = value.text();
  if (const auto named = ripeness_named(text)) return study::middle_share(*named);
  const char* const classes = "green, breakers, turning, pink, light_red or red";
  if (text.empty() || std::isalpha(static_cast<unsigned char>(text.front())))
    value.fail(std::string("must be a share from 0 to 1, or ") + classes + ", got " + excerpt(text));
  const double share = value.number();
  if (!(share >= 0.0 && share <= 1.0)) value.fail(std::string("must be from 0 to 1, or ") + classes + ", got " + text);
  return share;
}

/// A color: red, green, blue as whole numbers from 0 to 255.
Rgb read_color(const YamlValue& value) {
  if (value.list_size() != 3) value.fail("expected red, green and blue");
  Rgb out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const long long channel = value.at(c).integer();
    if (channel < 0 || channel > 255) value.at(c).fail("must be from 0 to 255, got " + std::to_string(channel));
    out[c] = static_cast<std::uint8_t>(channel);
  }
  return out;
}

/// Rejects a mesh that is no fruit's, since its units are wrong. @param value its path
void check_size(const Mesh& mesh, const YamlValue& value) {
  constexpr double kLeast = 0.001, kMost = 2.0;  // m, across
  const Aabb box = bounding_box(mesh.vertices);
  const double across = box.empty() ? 0.0 : box.size().maxCoeff();
  if (across > kMost)
    value.fail("a fruit " + metres(across) + " across: is the mesh in millimetres? Then give scale: 0.001");
  if (across < kLeast) value.fail("a fruit " + metres(across) + " across: does its scale fit the mesh?");
}

study::Object read_object(const YamlValue& value, MeshCache& meshes, std::set<int>& ids) {
  value.check_keys({"id", "class", "material", "ripeness", "color", "mesh", "xyz", "rpy", "scale"});
  study::Object object;
  object.cls = read_class(value.at("class"));
  if (value.has("material")) object.material = read_class(value.at("material"));
  const long long id = value.at("id").integer();
  const bool fruit = object.cls == study::ObjectClass::fruit;
  if (fruit && (id < 1 || id > 1000000))
    value.at("id").fail("the id of a fruit must be from 1 to 1000000, got " + std::to_string(id));
  if (!fruit && id != 0) value.at("id").fail("must be 0 for objects other than fruit, got " + std::to_string(id));
  object.id = static_cast<int>(id);
  if (value.has("ripeness")) {
    if (!fruit) value.at("ripeness").fail("only fruit have one");
    object.ripeness = read_ripeness(value.at("ripeness"));
  }
  if (value.has("color")) object.color = read_color(value.at("color"));
  if (fruit && !ids.insert(object.id).second) value.at("id").fail("two fruits have the id " + std::to_string(id));
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const bool moved = value.has("xyz") || value.has("rpy") || value.has("scale");
  const Pose pose = pose_from_xyz_rpy(value.has("xyz") ? value.at("xyz").numbers<3>() : zero,
                                      value.has("rpy") ? read_rpy(value.at("rpy")) : zero);
  const double scale = value.has("scale") ? positive(value.at("scale")) : 1.0;
  const Mesh& mesh = meshes.get(value.at("mesh"));
  object.mesh = moved ? transformed(mesh, pose, scale) : mesh;
  if (object.cls == study::ObjectClass::fruit) check_size(object.mesh, value.at("mesh"));
  return object;
}

/// The scene that a YAML document describes. @throws FileError as read_scene
SceneFile scene_of(const YAML::Node& document, const fs::path& path) {
  const YamlValue top(path, document, "");
  top.check_keys({"name", "robot", "sensor", "scan_volume", "keep_out", "objects"});
  SceneFile file;
  file.workcell.name = top.at("name").text();
  read_robot(top.at("robot"), file.workcell, file.warnings);
  if (top.has("sensor")) read_sensor(top.at("sensor"), file.workcell.sensor, file.warnings);
  file.workcell.scan_volume = read_volume(top.at("scan_volume"));
  if (top.has("keep_out")) {
    const YamlValue solids = top.at("keep_out");
    for (std::size_t i = 0; i < solids.list_size(); ++i) file.workcell.keep_out.push_back(read_keep_out(solids.at(i)));
  }
  const YamlValue objects = top.at("objects");
  MeshCache meshes(path.parent_path());
  std::set<int> ids;
  std::size_t size = 0;
  for (std::size_t i = 0; i < objects.list_size(); ++i) {
    file.scene.objects.push_back(read_object(objects.at(i), meshes, ids));
    // Objects may share a mesh, so a small scene file can describe a scene that is too large for the memory.
    constexpr std::size_t kMost = 100000000;
    const Mesh& mesh = file.scene.objects.back().mesh;
    size += mesh.vertices.size() + mesh.triangles.size();
    if (size > kMost) objects.at(i).fail("more than " + std::to_string(kMost) + " vertices and triangles in total");
  }
  return file;
}

}  // namespace

SceneFile read_scene(const fs::path& path) { return scene_of(load_yaml(path), path); }

SceneFile scene_from_yaml(const std::string& text, const fs::path& path) {
  return scene_of(parse_yaml(path, text), path);
}

}  // namespace agrisee::io
