// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/scene.hpp>

#include <cmath>
#include <set>

#include "io/formats/text.hpp"

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

/// A YAML list of numbers.
template <typename V>
std::string list(const V& values) {
  std::string out = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    check_input(std::isfinite(values[i]), "write_scene: a value is not finite");
    out += (i ? ", " : "") + format(static_cast<double>(values[i]));
  }
  return out + "]";
}

std::string pose(const Pose& pose) {
  check_input(is_rigid(pose), "write_scene: a pose is not rigid");
  return "{xyz: " + list(Eigen::Vector3d(pose.translation())) + ", rpy: " + list(rpy_of(pose.linear())) + "}";
}

/// A text as a YAML scalar: plain if that is safe, otherwise in double quotes.
std::string scalar(const std::string& text) {
  static const std::set<std::string> kReserved = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"};
  check_input(!text.empty(), "write_scene: a name is empty");
  bool plain = std::isalpha(static_cast<unsigned char>(text[0])) && kReserved.count(lower(text)) == 0;
  std::string quoted = "\"";
  for (const char c : text) {
    plain = plain && (std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.');
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < ' ' || c == 127) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned>(c));
      quoted += escape;
    } else {
      quoted += c;
    }
  }
  return plain ? text : quoted + "\"";
}

std::string sensor_map(const sensor::DepthCamera& sensor) {
  const sensor::Intrinsics& k = sensor.intrinsics;
  // Rounded to 1e-9 degrees, so that a field of view of 70 degrees is printed as 70.
  const auto fov = [](int pixels, double f) {
    return std::round(2.0 * std::atan(0.5 * pixels / f) / deg(1) * 1e9) * 1e-9;
  };
  const Eigen::Vector2d degrees(fov(k.width, k.fx), fov(k.height, k.fy));
  check_input(k.width > 0 && k.height > 0 && degrees.minCoeff() > 0.0 && degrees.maxCoeff() < 180.0 &&
                  k.cx == 0.5 * (k.width - 1) && k.cy == 0.5 * (k.height - 1),
              "write_scene: the sensor's intrinsics do not follow from fields of view");
  check_input(sensor.range_min >= 0.0 && sensor.range_min < sensor.range_max, "write_scene: bad sensor range");
  return "{model: l515, width: " + std::to_string(k.width) + ", height: " + std::to_string(k.height) +
         ", fov_deg: " + list(degrees) + ", range: " + list(Eigen::Vector2d(sensor.range_min, sensor.range_max)) + "}";
}

std::string solid(const KeepOut& k) {
  std::string out = "{name: " + scalar(k.name) + ", ";
  if (const Box* box = std::get_if<Box>(&k.shape)) {
    check_input(box->size.minCoeff() > 0.0, "write_scene: a keep-out box without size");
    out += "box: {center: " + list(box->center) + ", size: " + list(box->size) + "}";
  } else {
    const Cylinder& c = std::get<Cylinder>(k.shape);
    check_input(c.radius > 0.0 && c.height > 0.0, "write_scene: a keep-out cylinder without size");
    out += "cylinder: {center: " + list(c.center) + ", radius: " + format(c.radius) + ", height: " + format(c.height) +
           "}";
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

void check_ids(const study::Scene& scene) {
  std::set<int> ids;
  for (const study::Object& o : scene.objects) {
    const bool fruit = o.cls == study::ObjectClass::fruit;
    check_input(fruit ? o.id > 0 : o.id == 0, "write_scene: ids must be positive for fruit and 0 for other objects");
    check_input(!fruit || ids.insert(o.id).second, "write_scene: two fruits have the same id");
    check_input(!o.mesh.triangles.empty(), "write_scene: an object has no triangles");
  }
}

}  // namespace

void write_scene(const fs::path& path, const SceneFile& file) {
  const Workcell& cell = file.workcell;
  check_ids(file.scene);
  check_input((cell.scan_volume.min.array() < cell.scan_volume.max.array()).all(),
              "write_scene: the scan volume is empty");
  std::string out = "name: " + scalar(cell.name) + "\nrobot:\n  base: " + pose(cell.world_T_base) +
                    "\n  tool: " + pose(cell.tool0_T_optical) + "\n  start: " + list(cell.start) +
                    "\nsensor: " + sensor_map(cell.sensor) + "\nscan_volume: {min: " + list(cell.scan_volume.min) +
                    ", max: " + list(cell.scan_volume.max) + "}\n";
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
    out += "  - {id: " + std::to_string(o.id) + ", class: " + name_of(o.cls) + ", mesh: " + mesh + "}\n";
  }
  write_file(path, out);
}

}  // namespace agrisee::io
