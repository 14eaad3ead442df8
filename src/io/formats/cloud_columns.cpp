// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/cloud_columns.hpp"

#include <agrisee/core/unit_vector.hpp>
#include <agrisee/io/files.hpp>

#include <algorithm>
#include <cmath>

namespace agrisee::io {
namespace {

/// 0, 1 or 2 if `name` is `prefix` followed by x, y or z; else -1.
int axis_of(const std::string& name, const char* prefix) {
  const std::string p = prefix;
  for (int axis = 0; axis < 3; ++axis)
    if (name == p + "xyz"[axis]) return axis;
  return -1;
}

/// 0, 1 or 2 if `name` is a component of a normal (`nx` or `normal_x` and so on); else -1.
int normal_axis(const std::string& name) { return std::max(axis_of(name, "n"), axis_of(name, "normal_")); }

template <typename T>
Sink vector_sink(std::vector<Vector3<T>>& values, int axis) {
  return {values.empty() ? nullptr : values.front().data() + axis, nullptr, 3};
}

Sink int_sink(std::vector<int>& values) { return {nullptr, values.empty() ? nullptr : values.data(), 1}; }

/// A channel of a color, from a number in 0..255.
std::uint8_t channel_of(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(std::isfinite(value) ? value : 0.0f, 0.0f, 255.0f)));
}

}  // namespace

CloudColumns::CloudColumns(const std::filesystem::path& path, std::size_t points,
                           const std::vector<std::string>& names) {
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  for (const char* name : {"x", "y", "z"})
    if (!has(name)) fail(path, std::string("holds no point cloud: no property '") + name + "'");
  if (points > static_cast<std::size_t>(std::numeric_limits<Index>::max())) fail(path, "holds more than 2^31 points");
  bool normals[3] = {false, false, false};
  for (const std::string& name : names)
    if (normal_axis(name) >= 0) normals[normal_axis(name)] = true;
  file_.cloud.points.resize(points);
  if (normals[0] && normals[1] && normals[2]) file_.cloud.normals.resize(points);
  if (has("view")) file_.cloud.views.resize(points);
  instance_ = has("instance") ? "instance" : has("label") ? "label" : "";
  if (!instance_.empty()) file_.instance.resize(points);
  if (has("detection")) file_.cloud.instances.resize(points);
  find_colors(points, names);
}

/// Find the columns of the measured colors: `measured_red` and so on; else `red green blue` or `r g b`, unless there
/// is an `instance` that they paint; else `rgb` or `rgba`, packed as PCL does.
void CloudColumns::find_colors(std::size_t points, const std::vector<std::string>& names) {
  const auto has = [&](const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const char* const sets[][3] = {
      {"measured_red", "measured_green", "measured_blue"}, {"red", "green", "blue"}, {"r", "g", "b"}};
  for (const auto& set : sets) {
    if (!(has(set[0]) && has(set[1]) && has(set[2]))) continue;
    if (&set != &sets[0] && has("instance")) continue;
    std::copy(set, set + 3, channels_);
    channel_values_.resize(3 * points);
    return;
  }
  if (has("instance")) return;
  packed_ = has("rgb") ? "rgb" : has("rgba") ? "rgba" : "";
  if (!packed_.empty()) packs_.resize(points);
}

Sink CloudColumns::sink(const std::string& name, Scalar type) {
  const bool is_float = type == Scalar::f32 || type == Scalar::f64;
  for (std::size_t c = 0; c < 3; ++c)
    if (!name.empty() && name == channels_[c]) {
      whole_channels_ = whole_channels_ && !is_float;
      return {channel_values_.empty() ? nullptr : channel_values_.data() + c, nullptr, 3};
    }
  if (!name.empty() && name == packed_)
    return {nullptr, nullptr, 1, packs_.empty() ? nullptr : packs_.data(), is_float};
  if (name == "detection") return int_sink(file_.cloud.instances);
  if (const int axis = axis_of(name, ""); axis >= 0) return vector_sink(file_.cloud.points, axis);
  if (const int axis = normal_axis(name); axis >= 0) return vector_sink(file_.cloud.normals, axis);
  if (name == "view") return int_sink(file_.cloud.views);
  if (name == instance_) return int_sink(file_.instance);
  return {};
}

/// Turn what was read into colors. Floats of which none is above 1 reach from 0 to 1, else from 0 to 255.
void CloudColumns::finish_colors() {
  std::vector<Rgb>& colors = file_.cloud.colors;
  if (!channel_values_.empty()) {
    const bool unit = !whole_channels_ &&
                      std::all_of(channel_values_.begin(), channel_values_.end(), [](float v) { return !(v > 1.0f); });
    const float scale = unit ? 255.0f : 1.0f;
    for (std::size_t i = 0; i < channel_values_.size(); i += 3)
      colors.push_back({channel_of(scale * channel_values_[i]), channel_of(scale * channel_values_[i + 1]),
                        channel_of(scale * channel_values_[i + 2])});
  }
  for (const std::uint32_t bits : packs_)
    colors.push_back({static_cast<std::uint8_t>(bits >> 16 & 255u), static_cast<std::uint8_t>(bits >> 8 & 255u),
                      static_cast<std::uint8_t>(bits & 255u)});
}

CloudFile CloudColumns::finish(NonFinite non_finite, std::size_t width, std::size_t height) {
  Cloud& cloud = file_.cloud;
  for (Eigen::Vector3f& normal : cloud.normals) make_unit_or_zero(normal);
  finish_colors();
  file_.width = width;
  file_.height = height;
  if (non_finite == NonFinite::keep) return std::move(file_);
  const Indices finite = finite_indices(cloud);
  file_.dropped = cloud.points.size() - finite.size();
  if (file_.dropped > 0) {
    cloud = select(cloud, finite);
    Labels kept;
    for (const Index i : finite)
      if (!file_.instance.empty()) kept.push_back(file_.instance[static_cast<std::size_t>(i)]);
    file_.instance = std::move(kept);
    file_.width = finite.size();
    file_.height = 1;
  }
  return std::move(file_);
}

}  // namespace agrisee::io
