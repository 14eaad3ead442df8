// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/mcap.hpp>
#include <agrisee/version.hpp>

#include "io/formats/json_value.hpp"
#include "io/formats/mcap.hpp"
#include "io/formats/text.hpp"
#include "io/results/ros_messages.hpp"

namespace agrisee::io {
namespace {

constexpr const char *kWorld = "world", *kOptical = "camera_depth_optical_frame";
constexpr std::uint64_t kViewTime = 1000000000, kRestTime = 400000000;  // ns: a view a second, stands still before it

/// JSON schema of the part of foxglove.SceneUpdate that is written.
Json scene_schema() {
  const auto object = [](const Json& properties) { return Json{{"type", "object"}, {"properties", properties}}; };
  const auto list = [](const Json& items) { return Json{{"type", "array"}, {"items", items}}; };
  const auto numbers = [&](std::initializer_list<const char*> names) {
    Json properties;
    for (const char* name : names) properties[name] = {{"type", "number"}};
    return object(properties);
  };
  const Json text{{"type", "string"}}, boolean{{"type", "boolean"}}, number{{"type", "number"}},
      whole{{"type", "integer"}}, time = object({{"sec", whole}, {"nsec", whole}});
  const Json pose = object({{"position", numbers({"x", "y", "z"})}, {"orientation", numbers({"x", "y", "z", "w"})}});
  const Json color = numbers({"r", "g", "b", "a"}), any = list(Json{{"type", "object"}});
  const Json sphere = object({{"pose", pose}, {"size", numbers({"x", "y", "z"})}, {"color", color}});
  const Json label = object({{"pose", pose},
                             {"billboard", boolean},
                             {"font_size", number},
                             {"scale_invariant", boolean},
                             {"color", color},
                             {"text", text}});
  const Json entity = object({{"timestamp", time},
                              {"frame_id", text},
                              {"id", text},
                              {"lifetime", time},
                              {"frame_locked", boolean},
                              {"metadata", list(object({{"key", text}, {"value", text}}))},
                              {"arrows", any},
                              {"cubes", any},
                              {"spheres", list(sphere)},
                              {"cylinders", any},
                              {"lines", any},
                              {"triangles", any},
                              {"texts", list(label)},
                              {"models", any}});
  Json schema = object({{"deletions", any}, {"entities", list(entity)}});
  schema["title"] = "foxglove.SceneUpdate";
  return schema;
}

Json vector_json(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

/// The fruit as ellipsoids with their numbers.
Json scene_of(const std::vector<Fruit>& fruits, std::uint64_t time) {
  const Json none = Json::array(), stamp{{"sec", time / kViewTime}, {"nsec", time % kViewTime}};
  const Json zero{{"sec", 0}, {"nsec", 0}};
  Json out{{"deletions", none}, {"entities", none}};
  for (const Fruit& f : fruits) {
    const Eigen::Matrix3d axes = f.body ? f.body->axes : Eigen::Matrix3d::Identity().eval();
    const Eigen::Vector3d size = f.body ? Eigen::Vector3d(2.0 * f.body->radii) : Eigen::Vector3d::Constant(0.01).eval();
    const Eigen::Quaterniond q = quaternion(axes);
    const Json pose{{"position", vector_json(f.position())},
                    {"orientation", {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}}};
    Json data = none;
    const auto add = [&](const char* key, const std::string& value) {
      data.push_back({{"key", key}, {"value", value}});
    };
    add("truss", std::to_string(f.truss));
    add("found_by", f.found_by);
    if (f.body) add("confidence", format(f.body->confidence));
    if (f.ripeness) add("ripeness", to_string(f.ripeness->grade));
    const Json red{{"r", 0.85}, {"g", 0.2}, {"b", 0.15}, {"a", 0.6}}, white{{"r", 1}, {"g", 1}, {"b", 1}, {"a", 1}};
    out["entities"].push_back({{"timestamp", stamp},
                               {"frame_id", kWorld},
                               {"id", "fruit " + std::to_string(f.id)},
                               {"lifetime", zero},
                               {"frame_locked", true},
                               {"metadata", data},
                               {"arrows", none},
                               {"cubes", none},
                               {"spheres", {{{"pose", pose}, {"size", vector_json(size)}, {"color", red}}}},
                               {"cylinders", none},
                               {"lines", none},
                               {"triangles", none},
                               {"texts",
                                {{{"pose", pose},
                                  {"billboard", true},
                                  {"font_size", 14},
                                  {"scale_invariant", true},
                                  {"color", white},
                                  {"text", std::to_string(f.id)}}}},
                               {"models", none}});
  }
  return out;
}

std::string three_numbers(const Eigen::Vector3d& v) {
  return format(v.x()) + " " + format(v.y()) + " " + format(v.z());
}

/// Adds channels whose messages are those of ROS 2.
std::uint16_t add_ros(mcap::Writer& file, const ros::Type& type, const char* topic) {
  return file.add_channel(file.add_schema(type.name, "ros2msg", type.definition), topic, "cdr");
}

}  // namespace

void write_mcap(const std::filesystem::path& path, const Workcell& cell,
                const std::function<std::optional<ViewRecord>(std::size_t)>& view, const ScanResult& result) {
  mcap::Writer file(path, "ros2", "agrisee " AGRISEE_VERSION);
  const std::uint16_t transforms_schema =
      file.add_schema(ros::kTransforms.name, "ros2msg", ros::kTransforms.definition);
  const std::uint16_t fixed = file.add_channel(transforms_schema, "/tf_static", "cdr");
  const std::uint16_t moving = file.add_channel(transforms_schema, "/tf", "cdr");
  const std::uint16_t images = add_ros(file, ros::kImage, "/depth/image");
  const std::uint16_t cameras = add_ros(file, ros::kCameraInfo, "/depth/camera_info");
  const std::uint16_t joints = add_ros(file, ros::kJointState, "/joint_states");
  const std::uint16_t clouds = add_ros(file, ros::kPointCloud, "/cloud");
  const std::uint16_t scenes =
      file.add_channel(file.add_schema("foxglove.SceneUpdate", "jsonschema", scene_schema().dump()), "/fruit", "json");
  file.add_message(fixed, 0, ros::transform_message({0, kWorld}, "base_link", cell.world_T_base));
  std::uint64_t time = 0;
  for (std::size_t i = 0;; ++i) {
    const auto record = view(i);
    if (!record) break;
    check_input(is_rigid(record->world_T_optical), "write_mcap: a view's pose is not rigid");
    time += kViewTime;
    for (const std::uint64_t t : {time - kRestTime, time})
      file.add_message(moving, t, ros::transform_message({t, kWorld}, kOptical, record->world_T_optical));
    if (record->joints) file.add_message(joints, time, ros::joint_state_message({time, ""}, *record->joints));
    const ros::Header header{time, kOptical};
    file.add_message(cameras, time, ros::camera_info_message(header, record->frame.intrinsics));
    file.add_message(images, time, ros::image_message(header, record->frame));
  }
  time += kViewTime;
  file.add_message(clouds, time, ros::cloud_message({time, kWorld}, result.cloud, result.labels));
  file.add_message(scenes, time, scene_of(result.fruits, time).dump());
  file.add_metadata("agrisee", {{"name", cell.name},
                                {"scan_volume_min", three_numbers(cell.scan_volume.min)},
                                {"scan_volume_max", three_numbers(cell.scan_volume.max)}});
  file.close();
}

}  // namespace agrisee::io
