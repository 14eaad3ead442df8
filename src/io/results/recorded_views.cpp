// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/recorded_views.hpp>
#include <agrisee/sensor/in_range.hpp>

#include <cmath>

#include "io/formats/text.hpp"
#include "io/formats/yaml_camera.hpp"
#include "io/formats/yaml_map.hpp"
#include "io/formats/yaml_pose.hpp"
#include "io/formats/yaml_text.hpp"

namespace agrisee::io {
namespace {

namespace fs = std::filesystem;

sensor::Distortion read_distortion(const YamlValue& value, const sensor::Intrinsics& k) {
  std::vector<double> coefficients;
  for (std::size_t i = 0; i < value.list_size(); ++i) coefficients.push_back(value.at(i).number());
  try {
    const sensor::Distortion lens = sensor::distortion_from(coefficients);
    sensor::check(lens, k);
    return lens;
  } catch (const InputError& e) {
    value.fail(e.what());
  }
}

void read_camera(const YamlValue& value, RecordedViews& recorded) {
  value.check_keys({"width", "height", "fx", "fy", "cx", "cy", "depth_scale", "range", "distortion"});
  sensor::DepthCamera& camera = recorded.workcell.sensor;
  camera = sensor::DepthCamera();
  sensor::Intrinsics& k = camera.intrinsics;
  k.width = pixels(value.at("width"));
  k.height = pixels(value.at("height"));
  k.fx = positive(value.at("fx"));
  k.fy = positive(value.at("fy"));
  k.cx = value.at("cx").number();
  k.cy = value.at("cy").number();
  const auto inside = [](double c, int size) { return c >= -0.5 && c <= size - 0.5; };
  if (!inside(k.cx, k.width)) value.at("cx").fail("is outside of the image, got " + format(k.cx));
  if (!inside(k.cy, k.height)) value.at("cy").fail("is outside of the image, got " + format(k.cy));
  if (value.has("depth_scale")) recorded.depth_scale = positive(value.at("depth_scale"));
  if (value.has("distortion")) recorded.distortion = read_distortion(value.at("distortion"), k);
  camera.range_max = 1e6;  // no limit
  if (!value.has("range")) return;
  const Eigen::Vector2d range = read_range(value.at("range"));
  camera.range_min = range[0];
  camera.range_max = range[1];
}

/// The path that a value names, relative to the folder of views.yaml. @throws FileError if there is no such file
fs::path existing(const YamlValue& value, const RecordedViews& recorded) {
  const fs::path path = value.text();
  std::error_code error;
  if (!fs::exists(recorded.folder / path, error)) value.fail("no such file: " + (recorded.folder / path).string());
  return path;
}

RecordedView read_view(const YamlValue& value, RecordedViews& recorded) {
  if (value.has("camera"))
    value.at("camera").fail(
        "all views of a file share its one camera: write a file for each camera, and process them one by one");
  value.check_keys({"depth", "pose", "color", "masks", "boxes"});
  RecordedView view;
  const YamlValue depth = value.at("depth");
  view.depth = existing(depth, recorded);
  view.place = depth.place();
  ChannelFiles& files = view.channels;
  for (const auto& [key, path] : {std::pair{"color", &files.color}, {"masks", &files.masks}, {"boxes", &files.boxes}})
    if (value.has(key)) *path = existing(value.at(key), recorded);
  view.world_T_optical = read_pose(value.at("pose"), recorded.warnings);
  return view;
}

void check_scale(const std::string& place, const sensor::DepthFrame& frame, double scale) {
  const std::optional<double> median = sensor::median_depth(frame);
  if (!median || (*median >= 0.02 && *median <= 50.0)) return;
  throw FileError(place + ": the median depth is " + metres(*median) + ": is camera.depth_scale right? It is " +
                  format(scale) + " (metres per unit; for an image in millimetres 0.001)");
}

std::string rows_of(const Pose& pose) {
  check_input(is_rigid(pose), "write_recorded_views: a pose is not rigid");
  std::string out;
  for (int r = 0; r < 4; ++r) out += (r ? ", " : "[") + yaml_list(Eigen::RowVector4d(pose.matrix().row(r)));
  return out + "]";
}

}  // namespace

RecordedViews read_recorded_views(const fs::path& path) {
  const YamlValue top(path, load_yaml(path), "");
  top.check_keys({"name", "camera", "base", "scan_volume", "views"});
  RecordedViews recorded;
  recorded.folder = path.parent_path();
  recorded.workcell.name = top.has("name") ? top.at("name").text() : path.filename().string();
  read_camera(top.at("camera"), recorded);
  if (top.has("base")) recorded.workcell.world_T_base = read_pose(top.at("base"), recorded.warnings);
  if (top.has("scan_volume")) recorded.workcell.scan_volume = read_volume(top.at("scan_volume"));
  const YamlValue views = top.at("views");
  if (views.list_size() == 0) views.fail("expected at least one view");
  for (std::size_t i = 0; i < views.list_size(); ++i) recorded.views.push_back(read_view(views.at(i), recorded));
  return recorded;
}

sensor::DepthFrame read_frame(const RecordedViews& recorded, std::size_t number) {
  check_input(number < recorded.views.size(), "read_frame: there is no view with this number");
  const RecordedView& view = recorded.views[number];
  const sensor::DepthCamera& camera = recorded.workcell.sensor;
  const sensor::Intrinsics& k = camera.intrinsics;
  try {
    const DepthImage image = read_depth_image(recorded.folder / view.depth);
    if (image.width != k.width || image.height != k.height)
      throw FileError((recorded.folder / view.depth).string() + ": has " + std::to_string(image.width) + " x " +
                      std::to_string(image.height) + " pixels, but the camera " + std::to_string(k.width) + " x " +
                      std::to_string(k.height));
    const double scale = recorded.depth_scale.value_or(default_depth_scale(image));
    sensor::DepthFrame frame = to_frame(image, k, scale);
    check_scale((recorded.folder / view.depth).string(), frame, scale);
    const auto whole = [&](const fs::path& path) { return path.empty() ? path : recorded.folder / path; };
    const ChannelFiles& files = view.channels;
    add_channels(frame, {whole(files.color), whole(files.masks), whole(files.boxes)});
    return sensor::in_range(sensor::rectified(frame, recorded.distortion), camera.range_min, camera.range_max);
  } catch (const FileError& e) {
    throw FileError(view.place + ": " + e.what());
  }
}

Aabb extent_of(const sensor::DepthFrame& frame, const Pose& world_T_optical) {
  Aabb box;
  for (int v = 0; v < frame.intrinsics.height; ++v)
    for (int u = 0; u < frame.intrinsics.width; ++u)
      if (sensor::DepthFrame::valid(frame.at(u, v))) box.extend(world_T_optical * frame.point(u, v).cast<double>());
  return box;
}

void write_recorded_views(const fs::path& path, const RecordedViews& recorded) {
  const Workcell& cell = recorded.workcell;
  const sensor::Intrinsics& k = cell.sensor.intrinsics;
  std::string out;
  if (!cell.name.empty()) out += "name: " + yaml_quoted(cell.name) + "\n";
  out += "camera:\n  width: " + std::to_string(k.width) + "\n  height: " + std::to_string(k.height) + "\n";
  for (const auto& [key, value] : {std::pair{"fx", k.fx}, {"fy", k.fy}, {"cx", k.cx}, {"cy", k.cy}}) {
    check_input(std::isfinite(value), "write_recorded_views: the intrinsics are not finite");
    out += std::string("  ") + key + ": " + format(value) + "\n";
  }
  if (recorded.depth_scale) out += "  depth_scale: " + format(*recorded.depth_scale) + "\n";
  if (recorded.distortion.any())
    out += "  distortion: " + yaml_list(Eigen::Map<const Eigen::VectorXd>(recorded.distortion.k.data(), 8)) + "\n";
  if (cell.sensor.range_max < 1e6)
    out += "  range: " + yaml_list(Eigen::Vector2d(cell.sensor.range_min, cell.sensor.range_max)) + "\n";
  out += "base: " + rows_of(cell.world_T_base) + "\n";
  if (!cell.scan_volume.empty())
    out +=
        "scan_volume: {min: " + yaml_list(cell.scan_volume.min) + ", max: " + yaml_list(cell.scan_volume.max) + "}\n";
  out += "views:\n";
  for (const RecordedView& view : recorded.views) {
    out += "  - depth: " + yaml_quoted(view.depth.string()) + "\n    pose: " + rows_of(view.world_T_optical) + "\n";
    const ChannelFiles& files = view.channels;
    for (const auto& [key, file] : {std::pair{"color", &files.color}, {"masks", &files.masks}, {"boxes", &files.boxes}})
      if (!file->empty()) out += std::string("    ") + key + ": " + yaml_quoted(file->string()) + "\n";
  }
  write_file(path, out);
}

}  // namespace agrisee::io
