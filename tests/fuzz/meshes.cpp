// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/cloud.hpp>
#include <agrisee/io/mesh_file.hpp>

#include "targets.hpp"

namespace agrisee::fuzz {
namespace {

void check_mesh(const Mesh& mesh) {
  require(!mesh.triangles.empty(), "a mesh has a triangle");
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) require(v < mesh.vertices.size(), "indices are in range");
  for (const auto& v : mesh.vertices) require(is_finite(v), "vertices are finite");
}

}  // namespace

void stl(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path path = as_file(data, size);
  attempt([&] {
    const Mesh kept = io::read_stl(path, io::StlCorners::keep), merged = io::read_stl(path);
    check_mesh(kept);
    check_mesh(merged);
    require(kept.triangles.size() == merged.triangles.size(), "merging keeps the triangles");
    for (std::size_t t = 0; t < kept.triangles.size(); ++t)
      for (std::size_t c = 0; c < 3; ++c)
        require(kept.vertices[kept.triangles[t][c]] == merged.vertices[merged.triangles[t][c]],
                "merging keeps the corners");
  });
}

void obj(const std::uint8_t* data, std::size_t size) {
  attempt([&] { check_mesh(io::read_obj(as_file(data, size))); });
}

}  // namespace agrisee::fuzz
