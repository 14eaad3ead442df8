// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/mesh_file.hpp>

#include <limits>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace {

const auto reader = [](const std::filesystem::path& path) { return io::read_mesh(path); };

Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

std::string binary_stl(const Mesh& mesh, const std::string& title) {
  std::string out = title;
  out.resize(80, ' ');
  out += bytes_of<std::uint32_t>(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    out += std::string(12, '\0');
    for (const auto i : t)
      for (int a = 0; a < 3; ++a) out += bytes_of(mesh.vertices[i][a]);
    out += std::string(2, '\0');
  }
  return out;
}

std::string ascii_facet(const std::string& third = "0 1 0") {
  return " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.0e0 0 0\n   VERTEX " + third +
         "\n  endloop\n endfacet\n";
}

double error_of_volume(const Mesh& mesh) { return std::abs(volume(mesh) - 1.0 / 6.0); }

}  // namespace

TEST_CASE("STL round trip merges corners and keeps shape, orientation and order") {
  const TempFolder folder;
  io::write_stl(folder / "a.stl", tetrahedron());
  const Mesh mesh = io::read_mesh(folder / "a.stl");
  CHECK(mesh.vertices.size() == 4);
  REQUIRE(mesh.triangles.size() == 4);
  CHECK(error_of_volume(mesh) < 1e-7);
  const Mesh original = tetrahedron();
  for (std::size_t t = 0; t < 4; ++t)
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(mesh.vertices[mesh.triangles[t][c]] == original.vertices[original.triangles[t][c]]);
  const Mesh corners = io::read_mesh(folder / "a.stl", io::StlCorners::keep);
  CHECK(corners.vertices.size() == 12);
  CHECK(error_of_volume(corners) < 1e-7);
  io::write_stl(folder / "b.stl", mesh);
  CHECK(slurp(folder / "a.stl") == slurp(folder / "b.stl"));
}

TEST_CASE("merging thousands of corners equals the mesh they came from") {
  const TempFolder folder;
  constexpr std::uint32_t kSide = 60;
  Mesh mesh;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x)
      mesh.vertices.push_back({static_cast<float>(x), static_cast<float>(y), -0.0f});
  for (std::uint32_t y = 0; y + 1 < kSide; ++y)
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t i = y * kSide + x;
      mesh.triangles.push_back({i, i + 1, i + kSide});
      mesh.triangles.push_back({i + 1, i + kSide + 1, i + kSide});
    }
  io::write_stl(folder / "a.stl", mesh);
  const Mesh back = io::read_stl(folder / "a.stl");
  CHECK(back.vertices.size() == kSide * kSide);
  CHECK(area(back) == Approx(area(mesh)).epsilon(1e-12));
}

TEST_CASE("binary STL that begins with 'solid', trailing bytes, minus zero") {
  const TempFolder folder;
  CHECK(io::read_mesh(folder.file("a.stl", binary_stl(tetrahedron(), "solid is a lie"))).triangles.size() == 4);
  CHECK(io::read_mesh(folder.file("b.stl", binary_stl(tetrahedron(), "plain") + "more")).triangles.size() == 4);
  Mesh mesh = tetrahedron();
  mesh.vertices.push_back({-0.0f, 0.0f, -0.0f});
  mesh.triangles.push_back({4, 1, 2});
  CHECK(io::read_mesh(folder.file("c.stl", binary_stl(mesh, ""))).vertices.size() == 4);
}

TEST_CASE("ASCII STL, several solids, any case, without an extension") {
  const TempFolder folder;
  const std::string text = "solid first thing\n" + ascii_facet() + "endsolid first thing\nSOLID second\n" +
                           ascii_facet("0 -1 5e-1") + "endsolid\n";
  const Mesh mesh = io::read_mesh(folder.file("mesh", text));
  CHECK(mesh.triangles.size() == 2);
  CHECK(mesh.vertices.size() == 4);
  CHECK(mesh.vertices[3] == Eigen::Vector3f(0, -1, 0.5f));
}

TEST_CASE("OBJ: textures, normals, negative indices, polygons, faces before their vertices") {
  const TempFolder folder;
  const Mesh mesh = io::read_mesh(folder.file(
      "a.obj",
      "# comment\nmtllib a.mtl\no thing\nf 1/1/1 2/2 3//3\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n"
      "vt 0 0\ns off\nf -4 -3 -2 -1 # a square\n\nusemtl x\n"));
  CHECK(mesh.vertices.size() == 4);
  REQUIRE(mesh.triangles.size() == 3);
  CHECK(mesh.triangles[0] == std::array<std::uint32_t, 3>{0, 1, 2});
  CHECK(mesh.triangles[1] == std::array<std::uint32_t, 3>{0, 1, 2});
  CHECK(mesh.triangles[2] == std::array<std::uint32_t, 3>{0, 2, 3});
}

TEST_CASE("PLY meshes: round trip, colors, polygons as fans, ASCII and big-endian") {
  const TempFolder folder;
  io::write_ply_mesh(folder / "a.ply", tetrahedron());
  const Mesh plain = io::read_mesh(folder / "a.ply");
  CHECK(plain.vertices == tetrahedron().vertices);
  CHECK(plain.triangles == tetrahedron().triangles);
  io::write_ply_mesh(folder / "b.ply", tetrahedron(), {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}});
  CHECK(io::read_mesh(folder / "b.ply").triangles == tetrahedron().triangles);
  const Mesh fan = io::read_mesh(folder.file("mesh",
                                             "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty "
                                             "double y\nproperty double z\nelement face 1\n"
                                             "property uchar red\nproperty list uchar uint vertex_index\nend_header\n0 "
                                             "0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n255 5 0 1 2 3 4\n"));
  REQUIRE(fan.triangles.size() == 3);
  CHECK(fan.triangles[2] == std::array<std::uint32_t, 3>{0, 3, 4});
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list int short vertex_indices\nend_header\n";
  for (int i = 0; i < 9; ++i) big += bytes_of(static_cast<float>(i % 4), true);
  big += bytes_of<std::int32_t>(3, true);
  for (std::int16_t i = 0; i < 3; ++i) big += bytes_of<std::int16_t>(i, true);
  const Mesh mesh = io::read_mesh(folder.file("big.ply", big));
  CHECK(mesh.vertices[1] == Eigen::Vector3f(3, 0, 1));
  CHECK(mesh.triangles.size() == 1);
}

TEST_CASE("meshes that are not right are refused by name") {
  const TempFolder folder;
  const auto refuse = [&](const std::string& name, const std::string& bytes, const std::string& what) {
    require_file_error(folder.file(name, bytes), what, reader);
  };
  for (const char* name : {"missing.stl", "missing.ply", "missing.obj", "missing"})
    require_file_error(folder / name, "no such file", reader);
  require_file_error(folder.path(), "directory", reader);
  for (const char* name : {"empty.stl", "empty.ply", "empty.obj"}) refuse(name, "", "empty");
  const std::string good = binary_stl(tetrahedron(), "");
  refuse("a.stl", good.substr(0, good.size() - 1), "truncated");
  refuse("a.stl", good.substr(0, 60), "not an STL");
  refuse("a.stl", binary_stl(Mesh{}, ""), "no triangle");
  Mesh mesh = tetrahedron();
  mesh.vertices[2].y() = std::numeric_limits<float>::quiet_NaN();
  refuse("a.stl", binary_stl(mesh, ""), "not finite");
  CHECK_THROWS_AS(io::write_stl(folder / "x.stl", mesh), InputError);
  CHECK_THROWS_AS(io::write_ply_mesh(folder / "x.ply", mesh), InputError);
  mesh = tetrahedron();
  mesh.triangles[0][1] = 4;
  CHECK_THROWS_AS(io::write_stl(folder / "x.stl", mesh), InputError);
  CHECK_THROWS_AS(io::write_ply_mesh(folder / "x.ply", tetrahedron(), {{1, 2, 3}}), InputError);

  refuse("a.stl", "solid a\n" + ascii_facet("0 1 abc") + "endsolid\n", ":6: 'abc' is not a number");
  refuse("a.stl", "solid a\n" + ascii_facet("0 1") + "endsolid\n", ":6: a vertex with fewer than 3");
  refuse("a.stl", "solid a\n" + ascii_facet("nan 1 1") + "endsolid\n", "not finite");
  refuse("a.stl", "solid a\n" + ascii_facet("0 1 0\n vertex 1 1 1") + "endsolid\n", "more than 3");
  refuse("a.stl", "solid a\n" + ascii_facet(), "does not end with 'endsolid'");
  refuse("a.stl", "solid a\nwhatever\nendsolid\n", ":2: 'whatever' has no meaning");
  refuse("a.stl", "solid a\nendsolid\n", "no triangle");
  refuse("a.stl", "solid a\nvertex 0 0 0\nendsolid\n", "outside of a loop");

  refuse("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", ":4: vertex index 4 is out of range");
  refuse("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 -3\nv 0 1 0\n", ":3:");
  refuse("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 0\nv 0 1 0\n", ":3:");
  refuse("a.obj", "v 0 0 0\nv 1 0 0\nf 1 two 3\nv 0 1 0\n", ":3:");
  refuse("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "fewer than 3 corners");
  refuse("a.obj", "v 0 0 x\n", ":1: 'x' is not a number");
  refuse("a.obj", "v 0 0\n", "fewer than 3");
  refuse("a.obj", "v 0 0 0\n", "no triangle");
  refuse("a.obj", "v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n", "not finite");

  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  refuse("a.ply", ply + "3 0 1 3\n", "face 0: vertex index 3 is out of range");
  refuse("a.ply", ply + "3 0 1 -1\n", "out of range");
  refuse("a.ply", ply + "2 0 1\n", "fewer than 3 corners");
  refuse("a.ply", ply + "3 0 1\n", "no value");
  refuse("a.ply", ply + "99999999 0 1\n", "a list of");
  refuse("a.ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 "
         "0 0\n",
         "no faces");
}

TEST_CASE("degenerate triangles stay as they are") {
  const TempFolder folder;
  Mesh mesh = tetrahedron();
  mesh.triangles.push_back({1, 1, 2});
  io::write_stl(folder / "a.stl", mesh);
  CHECK(io::read_mesh(folder / "a.stl").triangles.size() == 5);
}

TEST_CASE("damaged meshes neither crash nor hang") {
  const TempFolder folder;
  survive_damage(folder, "a.stl", binary_stl(tetrahedron(), ""), reader);
  survive_damage(folder, "b.stl", "solid a\n" + ascii_facet() + "endsolid\n", reader);
  survive_damage(folder, "c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf -1 -2 -3\n", reader);
  io::write_ply_mesh(folder / "d.ply", tetrahedron());
  survive_damage(folder, "e.ply", slurp(folder / "d.ply"), reader);
}
