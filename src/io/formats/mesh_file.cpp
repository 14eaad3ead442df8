// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cloud.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/mesh_file.hpp>

#include <fstream>

#include "io/formats/mesh_checks.hpp"
#include "io/formats/ply_document.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io {

namespace fs = std::filesystem;

void check_mesh(const fs::path& path, const Mesh& mesh) {
  if (mesh.triangles.empty()) fail(path, "holds no triangle");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!is_finite(mesh.vertices[i])) fail(path, "vertex " + std::to_string(i) + " is not finite");
}

void check_writable(const Mesh& mesh) {
  for (const Eigen::Vector3f& v : mesh.vertices)
    check_input(is_finite(v), "a mesh to be written has a vertex that is not finite");
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t i : t)
      check_input(i < mesh.vertices.size(), "a mesh to be written has a vertex index out of range");
}

Mesh read_mesh(const fs::path& path, StlCorners corners) {
  char magic[4] = {};
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored)) std::ifstream(path, std::ios::binary).read(magic, 4);
  const std::string extension = lower(path.extension().string());
  if (extension == ".ply" || (std::string_view(magic, 3) == "ply" && is_blank(magic[3]))) return read_ply_mesh(path);
  if (extension == ".obj") return read_obj(path);
  return read_stl(path, corners);
}

Mesh read_ply_mesh(const fs::path& path) {
  PlyDocument document(path);
  const PlyElement* vertex = document.find("vertex");
  const PlyElement* face = document.find("face");
  if (!vertex || vertex->find({"x"}) < 0 || vertex->find({"y"}) < 0 || vertex->find({"z"}) < 0)
    fail(path, "holds no mesh: no vertices with x, y and z");
  const int list = face ? face->find({"vertex_indices", "vertex_index"}) : -1;
  if (list < 0 || !face->properties[static_cast<std::size_t>(list)].is_list)
    fail(path, "holds no mesh: no faces with a list 'vertex_indices'");
  if (vertex->count > 0xFFFFFFFFull) fail(path, "holds more than 2^32 vertices");

  Mesh mesh;
  mesh.vertices.resize(vertex->count);
  PlyDocument::Wanted vertices, faces;
  for (const PlyProperty& p : vertex->properties) {
    const int axis = p.is_list ? -1 : p.name == "x" ? 0 : p.name == "y" ? 1 : p.name == "z" ? 2 : -1;
    const bool take = axis >= 0 && !mesh.vertices.empty();
    vertices.sinks.push_back(take ? Sink{mesh.vertices.front().data() + axis, nullptr, 3} : Sink{});
  }
  faces.sinks.resize(face->properties.size());
  faces.list = list;
  mesh.triangles.reserve(face->count);
  faces.on_list = [&](std::size_t record, const std::vector<double>& polygon) {
    const auto bad = [&](const std::string& what) { fail(path, "face " + std::to_string(record) + what); };
    if (polygon.size() < 3) bad(" has fewer than 3 corners");
    for (const double index : polygon)
      if (!(index >= 0.0 && index < static_cast<double>(mesh.vertices.size())) || index != std::floor(index))
        bad(": vertex index " + format(index) + " is out of range");
    for (std::size_t i = 2; i < polygon.size(); ++i)
      mesh.triangles.push_back({static_cast<std::uint32_t>(polygon[0]), static_cast<std::uint32_t>(polygon[i - 1]),
                                static_cast<std::uint32_t>(polygon[i])});
  };
  document.read({{vertex, vertices}, {face, faces}});
  check_mesh(path, mesh);
  return mesh;
}

void write_ply_mesh(const fs::path& path, const Mesh& mesh, const std::vector<Rgb>& colors) {
  check_writable(mesh);
  check_input(colors.empty() || colors.size() == mesh.vertices.size(), "write_ply_mesh: not one color per vertex");
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment AgriSEE, metres\nelement vertex " +
                    std::to_string(mesh.vertices.size()) + "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!colors.empty()) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  out += "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
  const std::size_t header = out.size(), vertex_size = colors.empty() ? 12 : 15;
  out.resize(header + mesh.vertices.size() * vertex_size + mesh.triangles.size() * 13);
  char* at = out.data() + header;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (int a = 0; a < 3; ++a) put(at, mesh.vertices[i][a]);
    if (!colors.empty())
      for (std::uint8_t c : colors[i]) put(at, c);
  }
  for (const auto& t : mesh.triangles) {
    put(at, std::uint8_t{3});
    for (std::uint32_t i : t) put(at, i);
  }
  write_file(path, out);
}

}  // namespace agrisee::io
