// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/palette.hpp>
#include <agrisee/io/ply.hpp>

#include "io/formats/cloud_columns.hpp"
#include "io/formats/ply_document.hpp"
#include "io/formats/records.hpp"

namespace agrisee::io {
namespace {

std::string header(std::size_t points, const char* properties) {
  return "ply\nformat binary_little_endian 1.0\ncomment AgriSEE, metres, world frame\nelement vertex " +
         std::to_string(points) + "\nproperty float x\nproperty float y\nproperty float z\n" + properties +
         "end_header\n";
}

}  // namespace

CloudFile read_ply(const std::filesystem::path& path, NonFinite non_finite) {
  PlyDocument document(path);
  const PlyElement* vertex = document.find("vertex");
  if (!vertex) fail(path, "holds no point cloud: no element 'vertex'");
  std::vector<std::string> names;
  for (const PlyProperty& p : vertex->properties)
    if (!p.is_list) names.push_back(p.name);
  CloudColumns columns(path, vertex->count, names);
  PlyDocument::Wanted wanted;
  for (const PlyProperty& p : vertex->properties)
    wanted.sinks.push_back(p.is_list ? Sink{} : columns.sink(p.name, p.type));
  document.read({{vertex, wanted}});
  return columns.finish(non_finite, vertex->count, 1);
}

void write_ply(const std::filesystem::path& path, const Cloud& cloud, const Labels& instance) {
  check_input(instance.empty() || instance.size() == cloud.size(), "write_ply: not one label per point");
  check_input(cloud.normals.empty() || cloud.normals.size() == cloud.size(), "write_ply: not one normal per point");
  check_channels(cloud);
  std::string properties =
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int instance\n";
  const bool colored = !cloud.colors.empty(), detected = !cloud.instances.empty();
  if (colored)
    properties += "property uchar measured_red\nproperty uchar measured_green\nproperty uchar measured_blue\n";
  if (detected) properties += "property int detection\n";
  AtomicFile file(path);
  file.write(header(cloud.size(), properties.c_str()));
  const std::size_t size = 31 + (colored ? 3 : 0) + (detected ? 4 : 0);
  write_records(file, cloud.size(), size, [&](char*& at, std::size_t i) {
    const std::int32_t label = instance.empty() ? 0 : instance[i];
    put_vector(at, cloud.points[i]);
    put_vector(at, cloud.normals.empty() ? Eigen::Vector3f(0, 0, 0) : cloud.normals[i]);
    for (std::uint8_t c : fruit_color(label)) put(at, c);
    put(at, label);
    if (colored)
      for (const std::uint8_t c : cloud.colors[i]) put(at, c);
    if (detected) put(at, std::int32_t{cloud.instances[i]});
  });
  file.commit();
}

void write_raw_ply(const std::filesystem::path& path, const Cloud& cloud) {
  check_input(cloud.views.empty() || cloud.views.size() == cloud.size(), "write_raw_ply: not one view per point");
  AtomicFile file(path);
  file.write(header(cloud.size(), "property int view\n"));
  write_records(file, cloud.size(), 16, [&](char*& at, std::size_t i) {
    put_vector(at, cloud.points[i]);
    put(at, cloud.views.empty() ? std::int32_t{-1} : std::int32_t{cloud.views[i]});
  });
  file.commit();
}

}  // namespace agrisee::io
