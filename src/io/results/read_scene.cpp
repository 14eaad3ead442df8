// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/scene.hpp>

#include <map>
#include <set>

#include "io/formats/text.hpp"
#include "io/formats/yaml_map.hpp"

namespace agrisee::io {
namespace {

namespace fs = std::filesystem;

double positive(const YamlValue& value) {
  const double x = value.number();
  if (!(x > 0.0)) value.fail("must be positive, got " + format(x));
  return x;
}

Pose read_pose(const YamlValue& value) {
  value.check_keys({"xyz", "rpy"});
  return pose_from_xyz_rpy(value.at("xyz").numbers<3>(), value.at("rpy").numbers<3>());
}

void read_robot(const YamlValue& robot, Workcell& cell) {
  robot.check_keys({"base", "tool", "start"});
  cell.world_T_base = read_pose(robot.at("base"));
  if (robot.has("tool")) cell.tool0_T_optical = read_pose(robot.at("tool"));
  if (robot.has("start")) cell.start = robot.at("start").numbers<6>();
}

int pixels(const YamlValue& value) {
  constexpr long long kMost = 16384;
  const long long n = value.integer();
  if (n < 1 || n > kMost)
    value.fail("must be from 1 to " + std::to_string(kMost) + " pixels, got " + std::to_string(n));
  return static_cast<int>(n);
}

void read_sensor(const YamlValue& value, sensor::DepthCamera& sensor) {
  value.check_keys({"model", "width", "height", "fov_deg", "range"});
  if (value.has("model") && value.at("model").text() != "l515") value.at("model").fail("only 'l515' is known");
  const int width = value.has("width") ? pixels(value.at("width")) : sensor.intrinsics.width;
  const int height = value.has("height") ? pixels(value.at("height")) : sensor.intrinsics.height;
  Eigen::Vector2d fov(70.0, 55.0);
  if (value.has("fov_deg")) {
    fov = value.at("fov_deg").numbers<2>();
    if (!(fov.minCoeff() > 0.0 && fov.maxCoeff() < 180.0))
      value.at("fov_deg").fail("must be between 0 and 180 degrees");
  }
  sensor.intrinsics = sensor::intrinsics_from_fov(width, height, deg(fov.x()), deg(fov.y()));
  if (value.has("range")) {
    const Eigen::Vector2d range = value.at("range").numbers<2>();
    if (!(range[0] >= 0.0 && range[0] < range[1])) value.at("range").fail("expected 0 <= minimum < maximum");
    sensor.range_min = range[0];
    sensor.range_max = range[1];
  }
}

Aabb read_volume(const YamlValue& value) {
  value.check_keys({"min", "max"});
  Aabb volume;
  volume.min = value.at("min").numbers<3>();
  volume.max = value.at("max").numbers<3>();
  for (int a = 0; a < 3; ++a)
    if (!(volume.min[a] < volume.max[a]))
      value.fail(std::string("min must be below max, but along ") + "xyz"[a] + " min is " + format(volume.min[a]) +
                 " and max " + format(volume.max[a]));
  return volume;
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

study::Object read_object(const YamlValue& value, MeshCache& meshes, std::set<int>& ids) {
  value.check_keys({"id", "class", "mesh", "xyz", "rpy", "scale"});
  study::Object object;
  object.cls = read_class(value.at("class"));
  const long long id = value.at("id").integer();
  const bool fruit = object.cls == study::ObjectClass::fruit;
  if (fruit && (id < 1 || id > 1000000))
    value.at("id").fail("the id of a fruit must be from 1 to 1000000, got " + std::to_string(id));
  if (!fruit && id != 0) value.at("id").fail("must be 0 for objects other than fruit, got " + std::to_string(id));
  object.id = static_cast<int>(id);
  if (fruit && !ids.insert(object.id).second) value.at("id").fail("two fruits have the id " + std::to_string(id));
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const bool moved = value.has("xyz") || value.has("rpy") || value.has("scale");
  const Pose pose = pose_from_xyz_rpy(value.has("xyz") ? value.at("xyz").numbers<3>() : zero,
                                      value.has("rpy") ? value.at("rpy").numbers<3>() : zero);
  const double scale = value.has("scale") ? positive(value.at("scale")) : 1.0;
  const Mesh& mesh = meshes.get(value.at("mesh"));
  object.mesh = moved ? transformed(mesh, pose, scale) : mesh;
  return object;
}

}  // namespace

SceneFile read_scene(const fs::path& path) {
  const YamlValue top(path, load_yaml(path), "");
  top.check_keys({"name", "robot", "sensor", "scan_volume", "keep_out", "objects"});
  SceneFile file;
  file.workcell.name = top.at("name").text();
  read_robot(top.at("robot"), file.workcell);
  if (top.has("sensor")) read_sensor(top.at("sensor"), file.workcell.sensor);
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

}  // namespace agrisee::io
