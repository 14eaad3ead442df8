// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/mesh_file.hpp>

#include "io/formats/mesh_checks.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io {

Mesh read_obj(const std::filesystem::path& path) {
  const Bytes bytes = read_bytes(path);
  if (bytes.size == 0) fail(path, "is empty");
  Mesh mesh;
  Lines lines(bytes.view());
  std::string_view line;
  const auto bad = [&](const std::string& what) { fail(path, lines.number(), what); };
  long long largest = -1;        // largest vertex index used so far; a face may name vertices that follow later
  std::size_t largest_line = 0;  // line that used it
  while (lines.next_filled(line)) {
    const std::string_view keyword = next_word(line);
    if (keyword == "v") {
      mesh.vertices.push_back(next_vertex(line, bad));
    } else if (keyword == "f") {
      std::uint32_t first = 0, previous = 0;
      std::size_t corners = 0;
      for (std::string_view corner = next_word(line); !corner.empty(); corner = next_word(line)) {
        if (corner[0] == '#') break;
        const auto index = to_integer(corner.substr(0, corner.find('/')));  // v, v/vt, v//vn, v/vt/vn
        const auto vertices = static_cast<long long>(mesh.vertices.size());
        if (!index || *index == 0 || *index < -vertices || *index > 0xFFFFFFFFll)
          bad("vertex index " + excerpt(corner) + " is not a number or out of range");
        const long long i =
            *index > 0 ? *index - 1 : vertices + *index;  // counted from 1, or from the last vertex backwards
        if (i > largest) {
          largest = i;
          largest_line = lines.number();
        }
        const auto current = static_cast<std::uint32_t>(i);
        if (corners == 0) first = current;
        if (corners >= 2) mesh.triangles.push_back({first, previous, current});
        previous = current;
        ++corners;
      }
      if (corners < 3) bad("a face with fewer than 3 corners");
    } else if (keyword[0] != '#' && line.find('\0') != std::string_view::npos) {
      bad("is not an OBJ file");
    }  // normals, texture coordinates, groups and materials are skipped
  }
  if (largest >= static_cast<long long>(mesh.vertices.size()))
    fail(path, largest_line,
         "vertex index " + std::to_string(largest + 1) + " is out of range: the file has " +
             std::to_string(mesh.vertices.size()) + " vertices");
  check_mesh(path, mesh);
  return mesh;
}

}  // namespace agrisee::io
