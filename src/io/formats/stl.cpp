// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/mesh_file.hpp>

#include "io/formats/columns.hpp"
#include "io/formats/mesh_checks.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;  // bytes of a binary file

/// Gives corners with equal coordinates the same vertex: a hash table (open addressing) of the vertices found so far.
class Merger {
 public:
  Merger(Mesh& mesh, std::size_t corners) : mesh_(mesh) {
    std::size_t slots = 1024;
    while (slots < corners) slots *= 2;  // a closed mesh has about six corners per vertex
    slots_.assign(slots, 0);
  }
  std::uint32_t index(Eigen::Vector3f v) {
    v.array() += 0.0f;  // minus zero is zero
    if (2 * mesh_.vertices.size() >= slots_.size()) grow();
    std::uint32_t& slot = find(v);
    if (slot == 0) {
      mesh_.vertices.push_back(v);
      slot = static_cast<std::uint32_t>(mesh_.vertices.size());
    }
    return slot - 1;
  }

 private:
  /// The slot of a vertex with these coordinates, or the free slot where it belongs.
  std::uint32_t& find(const Eigen::Vector3f& v) {
    std::uint32_t bits[3];
    std::memcpy(bits, v.data(), sizeof bits);
    std::uint64_t hash = 0x9E3779B97F4A7C15ull;
    for (std::uint32_t b : bits) hash = (hash ^ b) * 0xFF51AFD7ED558CCDull, hash ^= hash >> 32;
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = static_cast<std::size_t>(hash) & mask;
    while (slots_[i] != 0 && std::memcmp(mesh_.vertices[slots_[i] - 1].data(), v.data(), sizeof bits) != 0)
      i = (i + 1) & mask;
    return slots_[i];
  }
  void grow() {
    slots_.assign(2 * slots_.size(), 0);
    for (std::size_t i = 0; i < mesh_.vertices.size(); ++i) find(mesh_.vertices[i]) = static_cast<std::uint32_t>(i + 1);
  }
  Mesh& mesh_;
  std::vector<std::uint32_t> slots_;  // vertex index + 1; 0 for a free slot
};

/// The number of facets that the header of a binary file states; 0 for a shorter file.
std::size_t facet_count(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + 80, 4);
  return count;
}

bool begins_with_solid(std::string_view bytes) {
  std::string_view rest = bytes.substr(0, 256);
  return lower(next_word(rest)) == "solid";
}

/// Whether the size of the file is exactly that of a binary file with facet_count() facets. Binary files may begin with
/// `solid`, too.
bool is_binary(std::string_view bytes) {
  return bytes.size() >= kHeader && bytes.size() == kHeader + kFacet * facet_count(bytes);
}

/// The corners of a binary file, three per facet.
std::vector<Eigen::Vector3f> binary_corners(const std::filesystem::path& path, std::string_view bytes) {
  if (bytes.size() < kHeader) fail(path, "is not an STL file: neither 'solid' nor a binary header");
  const std::size_t facets = facet_count(bytes);
  if (facets > (bytes.size() - kHeader) / kFacet)
    fail(path, "is not an STL file, or truncated: its header promises " + std::to_string(facets) +
                   " facets, but only " + std::to_string(bytes.size() - kHeader) + " bytes follow");
  std::vector<Eigen::Vector3f> corners(3 * facets);
  for (std::size_t f = 0; f < facets; ++f)
    std::memcpy(corners[3 * f].data(), bytes.data() + kHeader + kFacet * f + 12, 36);
  return corners;
}

/// The corners of an ASCII file, three per facet.
std::vector<Eigen::Vector3f> text_corners(const std::filesystem::path& path, std::string_view bytes) {
  std::vector<Eigen::Vector3f> corners;
  Lines lines(bytes);
  std::string_view line;
  const auto bad = [&](const std::string& what) { fail(path, lines.number(), what); };
  std::size_t in_loop = 0;
  bool loop = false, ended = false;
  while (lines.next_filled(line)) {
    const std::string_view first = next_word(line);
    const std::string word = first.size() <= 16 ? lower(first) : std::string(first);
    if (word == "vertex") {
      if (!loop) bad("a vertex outside of a loop");
      if (++in_loop > 3) bad("a facet with more than 3 vertices");
      corners.push_back(next_vertex(line, bad));
    } else if (word == "outer") {
      if (loop) bad("a loop inside of a loop");
      loop = true;
      in_loop = 0;
    } else if (word == "endloop") {
      if (!loop || in_loop != 3) bad("a facet with " + std::to_string(in_loop) + " vertices");
      loop = false;
    } else if (word == "solid" || word == "endsolid") {
      ended = word == "endsolid";
    } else if (word != "facet" && word != "endfacet") {
      bad(excerpt(first) + " has no meaning in an ASCII STL file");
    }
  }
  if (loop || !ended) fail(path, "truncated: the ASCII STL file does not end with 'endsolid'");
  return corners;
}

}  // namespace

Mesh read_stl(const std::filesystem::path& path, StlCorners corners) {
  const Bytes bytes = read_bytes(path);
  if (bytes.size == 0) fail(path, "is empty");
  const bool text = begins_with_solid(bytes.view()) && !is_binary(bytes.view());
  std::vector<Eigen::Vector3f> all = text ? text_corners(path, bytes.view()) : binary_corners(path, bytes.view());
  Mesh mesh;
  mesh.triangles.resize(all.size() / 3);
  if (corners == StlCorners::keep) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t c = 0; c < 3; ++c) mesh.triangles[t][c] = static_cast<std::uint32_t>(3 * t + c);
    mesh.vertices = std::move(all);
  } else {
    Merger merger(mesh, all.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t c = 0; c < 3; ++c) mesh.triangles[t][c] = merger.index(all[3 * t + c]);
  }
  check_mesh(path, mesh);
  return mesh;
}

void write_stl(const std::filesystem::path& path, const Mesh& mesh) {
  check_writable(mesh);
  std::string out(kHeader + kFacet * mesh.triangles.size(), '\0');
  constexpr std::string_view kTitle = "AgriSEE, binary STL, metres";  // must not begin with "solid"
  std::memcpy(out.data(), kTitle.data(), kTitle.size());
  char* at = out.data() + 80;
  put(at, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
                          c = mesh.vertices[t[2]].cast<double>();
    Eigen::Vector3d normal = (b - a).cross(c - a);
    const double length = normal.norm();
    normal = length > 0.0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d(0.0, 0.0, 0.0);
    for (int i = 0; i < 3; ++i) put(at, static_cast<float>(normal[i]));
    for (const std::uint32_t v : t)
      for (int i = 0; i < 3; ++i) put(at, mesh.vertices[v][i]);
    put(at, std::uint16_t{0});
  }
  write_file(path, out);
}

}  // namespace agrisee::io
