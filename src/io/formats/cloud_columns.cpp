// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/cloud_columns.hpp"

#include <agrisee/io/files.hpp>

#include <algorithm>

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

/// Scale a normal to unit length; set it to zero if it has no direction.
void tidy(Eigen::Vector3f& normal) {
  const float norm = normal.norm();
  if (!(std::isfinite(norm) && norm > 1e-12f))
    normal.setZero();
  else if (std::abs(norm - 1.0f) > 1e-5f)  // a unit vector is not changed, not even in its last bit
    normal /= norm;
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
}

Sink CloudColumns::sink(const std::string& name) {
  if (const int axis = axis_of(name, ""); axis >= 0) return vector_sink(file_.cloud.points, axis);
  if (const int axis = normal_axis(name); axis >= 0) return vector_sink(file_.cloud.normals, axis);
  if (name == "view") return int_sink(file_.cloud.views);
  if (name == instance_) return int_sink(file_.instance);
  return {};
}

CloudFile CloudColumns::finish(NonFinite non_finite, std::size_t width, std::size_t height) {
  Cloud& cloud = file_.cloud;
  for (Eigen::Vector3f& normal : cloud.normals) tidy(normal);
  file_.width = width;
  file_.height = height;
  if (non_finite == NonFinite::keep) return std::move(file_);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!is_finite(cloud.points[i])) continue;
    if (kept != i) {
      cloud.points[kept] = cloud.points[i];
      if (!cloud.normals.empty()) cloud.normals[kept] = cloud.normals[i];
      if (!cloud.views.empty()) cloud.views[kept] = cloud.views[i];
      if (!file_.instance.empty()) file_.instance[kept] = file_.instance[i];
    }
    ++kept;
  }
  file_.dropped = cloud.points.size() - kept;
  if (file_.dropped > 0) {
    cloud.points.resize(kept);
    if (!cloud.normals.empty()) cloud.normals.resize(kept);
    if (!cloud.views.empty()) cloud.views.resize(kept);
    if (!file_.instance.empty()) file_.instance.resize(kept);
    file_.width = kept;
    file_.height = 1;
  }
  return std::move(file_);
}

}  // namespace agrisee::io
