// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/scene.hpp>

#include <cmath>
#include <set>

#include "io/formats/text.hpp"
#include "io/formats/yaml_text.hpp"

namespace agrisee::io {
namespace {

namespace fs = std::filesystem;

/// Roll, pitch and yaw (rad, as in URDF) of a rotation; at the singularity the yaw is 0. They are rounded to 1e-14 rad,
/// so that angles that were read from a file are written unchanged.
Eigen::Vector3d rpy_of(const Eigen::Matrix3d& r) {
  const double cos_pitch = std::hypot(r(0, 0), r(1, 0));
  Eigen::Vector3d rpy(0.0, std::atan2(-r(2, 0), cos_pitch), 0.0);
  if (cos_pitch < 1e-9) {
    rpy[0] = std::atan2(-r(1, 2), r(1, 1));
  } else {
    rpy[0] = std::atan2(r(2, 1), r(2, 2));
    rpy[2] = std::atan2(r(1, 0), r(0, 0));
  }
  return (rpy * 1e14).array().round() / 1e14;
}

std::string pose(const Pose& pose) {
  check_input(is_rigid(pose), "write_scene: a pose is not rigid");
  return "{xyz: " + yaml_list(Eigen::Vector3d(pose.translation())) + ", rpy: " + yaml_list(rpy_of(pose.linear())) + "}";
}

/// A text as a YAML scalar: plain if that is safe, otherwise in double quotes.
std::string scalar(const std::string& text) {
  static const std::set<std::string> kReserved = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"};
  check_input(!text.empty(), "write_scene: a name is empty");
  bool plain = std::isalpha(static_cast<unsigned char>(text[0])) && kReserved.count(lower(text)) == 0;
  for (const char c : text)
    plain = plain && (std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.');
  return plain ? text : yaml_quoted(text);
}

std::string sensor_map(const sensor::DepthCamera& sensor) {
  const sensor::Intrinsics& k = sensor.intrinsics;
  // Rounded to 1e-9 degrees, so that a field of view of 70 degrees is printed as 70.
  const auto fov = [](int pixels, double f) {
    return std::round(2.0 * std::atan(0.5 * pixels / f) / deg(1) * 1e9) * 1e-9;
  };
  try {
    sensor.check();
  } catch (const ParameterError& e) {
    throw InputError(std::string("write_scene: ") + e.what());
  }
  const Eigen::Vector2d degrees(fov(k.width, k.fx), fov(k.height, k.fy));
  const sensor::Intrinsics by_fov = sensor::intrinsics_from_fov(k.width, k.height, deg(degrees.x()), deg(degrees.y()));
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-9 * b; };
  const bool centered = k.cx == by_fov.cx && k.cy == by_fov.cy && near(k.fx, by_fov.fx) && near(k.fy, by_fov.fy);
  std::string out = "{model: l515, width: " + std::to_string(k.width) + ", height: " + std::to_string(k.height);
  if (centered)
    out += ", fov_deg: " + yaml_list(degrees);
  else
    out += ", fx: " + format(k.fx) + ", fy: " + format(k.fy) + ", cx: " + format(k.cx) + ", cy: " + format(k.cy);
  out += ", range: " + yaml_list(Eigen::Vector2d(sensor.range_min, sensor.range_max));
  const sensor::DepthCamera usual;  // with the housing of an L515
  if (sensor.housing_radius != usual.housing_radius || sensor.housing_depth != usual.housing_depth)
    out += ", housing: {radius: " + format(sensor.housing_radius) + ", depth: " + format(sensor.housing_depth) + "}";
  return out + "}";
}

std::string solid(const KeepOut& k) {
  std::string out = "{name: " + scalar(k.name) + ", ";
  if (const Box* box = std::get_if<Box>(&k.shape)) {
    check_input(box->size.minCoeff() > 0.0, "write_scene: a keep-out box without size");
    out += "box: {center: " + yaml_list(box->center) + ", size: " + yaml_list(box->size) + "}";
  } else {
    const Cylinder& c = std::get<Cylinder>(k.shape);
    check_input(c.radius > 0.0 && c.height > 0.0, "write_scene: a keep-out cylinder without size");
    out += "cylinder: {center: " + yaml_list(c.center) + ", radius: " + format(c.radius) +
           ", height: " + format(c.height) + "}";
  }
  return out + "}";
}

const char* name_of(study::ObjectClass cls) {
  switch (cls) {
    case study::ObjectClass::fruit:
      return "fruit";
    case study::ObjectClass::stem:
      return "stem";
    case study::ObjectClass::leaf:
      return "leaf";
    case study::ObjectClass::other:
      break;
  }
  return "other";
}

/// The keys of an object that say how it looks, each with a comma before it.
std::string look_of(const study::Object& o) {
  std::string out;
  if (o.ripeness) out += ", ripeness: " + format(*o.ripeness);
  if (o.color)
    out += ", color: [" + std::to_string((*o.color)[0]) + ", " + std::to_string((*o.color)[1]) + ", " +
           std::to_string((*o.color)[2]) + "]";
  return out;
}

void check_ids(const study::Scene& scene) {
  std::set<int> ids;
  for (const study::Object& o : scene.objects) {
    const bool fruit = o.cls == study::ObjectClass::fruit;
    check_input(fruit ? o.id > 0 : o.id == 0, "write_scene: ids must be positive for fruit and 0 for other objects");
    check_input(!fruit || ids.insert(o.id).second, "write_scene: two fruits have the same id");
    check_input(!o.mesh.triangles.empty(), "write_scene: an object has no triangles");
    check_input(!o.ripeness || (fruit && *o.ripeness >= 0.0 && *o.ripeness <= 1.0),
                "write_scene: a ripeness must be that of a fruit, from 0 to 1");
  }
}

}  // namespace

void write_scene(const fs::path& path, const SceneFile& file) {
  const Workcell& cell = file.workcell;
  check_ids(file.scene);
  check_input((cell.scan_volume.min.array() < cell.scan_volume.max.array()).all(),
              "write_scene: the scan volume is empty");
  const std::string arm = cell.arm.name == arm::UrModel().name ? "" : "  arm: " + std::string(cell.arm.name) + "\n";
  std::string out = "name: " + scalar(cell.name) + "\nrobot:\n" + arm + "  base: " + pose(cell.world_T_base) +
                    "\n  tool: " + pose(cell.tool0_T_optical) +
                    (cell.tool0_T_tool ? "\n  gripper: " + pose(*cell.tool0_T_tool) : "") +
                    "\n  start: " + yaml_list(cell.start) + "\nsensor: " + sensor_map(cell.sensor) +
                    "\nscan_volume: {min: " + yaml_list(cell.scan_volume.min) +
                    ", max: " + yaml_list(cell.scan_volume.max) + "}\n";
  if (!cell.keep_out.empty()) out += "keep_out:\n";
  for (const KeepOut& k : cell.keep_out) out += "  - " + solid(k) + "\n";
  out += file.scene.objects.empty() ? "objects: []\n" : "objects:\n";
  std::size_t count[4] = {0, 0, 0, 0};
  for (const study::Object& o : file.scene.objects) {
    const std::size_t number = ++count[static_cast<std::size_t>(o.cls)];
    const std::string mesh =
        std::string(name_of(o.cls)) + "_" +
        std::to_string(o.cls == study::ObjectClass::fruit ? static_cast<std::size_t>(o.id) : number) + ".stl";
    write_stl(path.parent_path() / mesh, o.mesh);
    out += "  - {id: " + std::to_string(o.id) + ", class: " + name_of(o.cls) +
           (o.material ? std::string(", material: ") + name_of(*o.material) : "") + look_of(o) + ", mesh: " + mesh +
           "}\n";
  }
  write_file(path, out);
}

}  // namespace agrisee::io
