// SPDX-License-Identifier: BSD-3-Clause
#include "seeds.hpp"

#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/mcap.hpp>
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/ply.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/io/scene.hpp>

#include <cstring>

#include "targets.hpp"

namespace agrisee::fuzz {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) { return std::string(io::read_bytes(path).view()); }

template <typename T>
void put(std::string& out, std::initializer_list<T> values) {
  for (const T value : values) out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

Cloud seed_cloud() {
  Cloud cloud;
  for (int i = 0; i < 3; ++i) {
    cloud.points.emplace_back(0.1f * float(i), 0.5f, -0.25f);
    cloud.normals.emplace_back(0.0f, 0.0f, 1.0f);
    cloud.views.push_back(i);
  }
  return cloud;
}

std::string pcd_header(const char* data) {
  return std::string(
             "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\n"
             "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ") +
         data + "\n";
}

std::vector<View> seed_views() {
  View view;
  view.target = {0.0, 0.0, 0.4};
  view.joints = Joints::Zero();
  view.points_in = 7;
  return {view, View{}};
}

Fruit seed_fruit() {
  Fruit fruit;
  fruit.id = 1;
  fruit.points = 100;
  fruit.found_by = "dbscan";
  fruit.body = Body{};
  fruit.body->radii = {0.03, 0.03, 0.02};
  fruit.picking = Picking{};
  fruit.picking->order = 1;
  return fruit;
}

void add_clouds(std::vector<Seed>& seeds, const fs::path& folder) {
  const Cloud cloud = seed_cloud();
  io::write_ply(folder / "cloud", cloud, {0, 1, 2});
  io::write_raw_ply(folder / "raw", cloud);
  io::write_ply_mesh(folder / "mesh", seed_mesh());
  for (const char* name : {"cloud", "raw", "mesh"}) seeds.push_back({"ply", name, bytes_of(folder / name)});
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty double x\nproperty short y\n"
      "property uchar z\nproperty list uchar int more\nend_header\n";
  big += std::string("\x3f\xf0\0\0\0\0\0\0", 8) + std::string("\1\2\7\1\0\0\0\5", 8);
  seeds.push_back({"ply", "big_endian", big});
  seeds.push_back(
      {"ply", "ascii",
       "ply\nformat ascii 1.0\ncomment c\nobj_info o\nelement vertex 3\nproperty float x\nproperty float y\n"
       "property float z\nproperty int label\nelement face 1\nproperty list uchar int vertex_indices\n"
       "end_header\n0 0 0 1\n1 nan 0 2\n0 1e-3 0 -1\n3 0 1 2\n"});

  seeds.push_back({"pcd", "ascii", pcd_header("ascii") + "1 2 3 4\nnan 1e5 -0.5 0\n"});
  std::string binary;
  put<float>(binary, {1.0f, 2.0f, 3.0f});
  put<std::uint32_t>(binary, {4});
  put<float>(binary, {5.0f, 6.0f, 7.0f});
  put<std::uint32_t>(binary, {8});
  seeds.push_back({"pcd", "binary", pcd_header("binary") + binary});
  std::string compressed;  // one literal run of 32 bytes
  put<std::uint32_t>(compressed, {33, 32});
  compressed += '\x1f' + binary;
  seeds.push_back({"pcd", "compressed", pcd_header("binary_compressed") + compressed});
  std::string repeated;  // 1 literal byte, then copies of it: 2 + 7 + 2, and 22 - 9 + 2 more
  put<std::uint32_t>(repeated, {7, 32});
  repeated += std::string("\0\0\xe0\x0d\0\x80\0", 7);
  seeds.push_back({"pcd", "copies", pcd_header("binary_compressed") + repeated});
}

void add_tables(std::vector<Seed>& seeds) {
  seeds.push_back({"table", "xyz", "1 2 3\n# c\n4 -5e-3 nan 6\n"});
  seeds.push_back({"table", "named", "//X Y Z nx ny nz view label\n1 2 3 0 0 1 4 5\n"});
  seeds.push_back({"table", "csv", "z;x;y;\"name\"\n1;2;3;a\n;;;\n"});
}

/// A recording of two views; once more without the checksum of its chunk, behind which damage is not looked at.
void add_mcap(std::vector<Seed>& seeds, const fs::path& folder) {
  const auto view = [](std::size_t i) -> std::optional<io::ViewRecord> {
    if (i == 2) return std::nullopt;
    io::ViewRecord record;
    record.frame.intrinsics = {4, 2, 5.0, 6.0, 1.5, 0.5};
    record.frame.depth.assign(8, 0.5f);
    record.world_T_optical.translation().x() = 0.1 * static_cast<double>(i);
    return record;
  };
  Workcell cell;
  cell.scan_volume.min = Eigen::Vector3d::Constant(-1.0);
  cell.scan_volume.max = Eigen::Vector3d::Constant(1.0);
  io::write_mcap(folder / "scan.mcap", cell, view, {});
  std::string bytes = bytes_of(folder / "scan.mcap");
  seeds.push_back({"mcap", "scan", bytes});
  const std::size_t chunk = 8 + 9 + static_cast<unsigned char>(bytes[9]);  // behind the magic and a short header
  bytes.replace(chunk + 9 + 24, 4, 4, '\0');
  seeds.push_back({"mcap", "unchecked", bytes});
}

void add_depth(std::vector<Seed>& seeds, const fs::path& folder) {
  sensor::DepthFrame frame;
  frame.intrinsics = {4, 2, 5.0, 6.0, 1.5, 0.5};
  frame.depth = {0.5f, 0.51f, 0.0f, 0.52f, 0.5f, 0.5f, 70.0f, 0.4f};
  io::write_depth_png(folder / "depth.png", frame);
  io::write_depth_npy(folder / "depth.npy", frame);
  for (const char* name : {"depth.png", "depth.npy"}) seeds.push_back({"depth", name, bytes_of(folder / name)});
  seeds.push_back({"table", "npy", bytes_of(folder / "depth.npy")});
  const std::string camera = "camera: {width: 4, height: 2, fx: 5, fy: 6, cx: 1.5, cy: 0.5, depth_scale: 1e-3}\n";
  seeds.push_back(
      {"recorded", "matrix",
       "name: a\n" + camera + "views:\n- {depth: d.png, pose: [[1, 0, 0, 7], [0, 1, 0, 8], [0, 0, 1, 9]]}\n"});
  seeds.push_back({"recorded", "forms",
                   camera + "base: {xyz: [1, 2, 3], quaternion: [0, 0, 0.6, 0.8]}\n"
                            "scan_volume: {min: [0, 0, 0], max: [1, 1, 1]}\n"
                            "views: [{depth: d.png, pose: {xyz: [1, 2, 3], rpy: [0.1, 0.2, 0.3]}}]\n"});
}

void add_meshes(std::vector<Seed>& seeds, const fs::path& folder) {
  io::write_stl(folder / "stl", seed_mesh());
  seeds.push_back({"stl", "binary", bytes_of(folder / "stl")});
  seeds.push_back({"stl", "ascii",
                   "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e-2 0\nendloop\n"
                   "endfacet\nendsolid s\n"});
  seeds.push_back({"obj", "plain",
                   "# c\nmtllib m\no t\nv 0 0 0\nv 1 0 0 1\nv 0 1 0\nv 0 0 -1e-2\nvt 0 0\nvn 0 0 1\ns off\nf 1 2 3\n"
                   "f 1/1 2/1 -1/1\nf 1//1 3//1 4//1 2//1\nf 1/1/1 2/1/1 3/1/1\n"});
}

void add_texts(std::vector<Seed>& seeds, const fs::path& folder) {
  io::SceneFile scene;
  scene.workcell.name = "seed";
  scene.workcell.scan_volume.extend(Eigen::Vector3d(-0.1, 0.4, 0.0));
  scene.workcell.scan_volume.extend(Eigen::Vector3d(0.1, 0.6, 0.3));
  scene.workcell.keep_out.push_back({"box", Box{{0, 0, -1}, {1, 1, 1}}});
  scene.workcell.keep_out.push_back({"post", Cylinder{{0, 1, 0}, 0.1, 1.0}});
  scene.scene.objects.push_back({1, study::ObjectClass::fruit, seed_mesh()});
  io::write_scene(folder / "scene.yaml", scene);
  seeds.push_back({"scene", "written", bytes_of(folder / "scene.yaml")});
  seeds.push_back(
      {"scene", "moved",
       "name: a\nrobot:\n  base: {xyz: [0, 0, 0], rpy: [0, 0, 0.5]}\nscan_volume: {min: [0, 0, 0], max: [1, 1, 1]}\n"
       "objects:\n  - &o {id: 1, class: fruit, mesh: fruit_1.stl, xyz: [1, 2, 3], rpy: [0, 0, 0.4], scale: 2}\n"
       "  - {id: 0, class: leaf, mesh: ./fruit_1.stl}\n"});

  for (const char* preset : kPresetNames)
    seeds.push_back({"parameters", preset, io::parameters_to_yaml(Parameters::named(preset))});
  seeds.push_back(
      {"parameters", "few", "preset: paper\nmax_views: 3\nsor: {mean_k: 12, std_ratio: 1.5}\nicp:\n  kernel: huber\n"});

  io::ScanTask task;
  task.scene = "/s.yaml";
  task.content = "0";
  task.version = "1";
  task.planner = "gain";
  io::write_scan_task(folder / "scan.json", task);
  seeds.push_back({"records", "task", "t" + bytes_of(folder / "scan.json")});
  io::ViewRecord record;
  record.frame.intrinsics = {8, 6, 10.0, 10.0, 3.5, 2.5};
  record.frame.depth.assign(48, 0.0f);
  for (std::size_t i = 10; i < 20; ++i) record.frame.depth[i] = 0.1f * float(i);
  record.joints = Joints::Zero();
  io::write_view_record(folder, 2, record, "scan");
  seeds.push_back({"records", "view", "v" + bytes_of(io::view_record_path(folder, 2))});
  ScanResult result;
  result.views = seed_views();
  result.fruits = {seed_fruit()};
  io::RunInfo info;
  info.scene = "seed";
  io::write_run(folder / "run.json", result, info);
  io::write_fruits(folder / "fruits.json", result.fruits);
  io::write_views(folder / "views.csv", result.views);
  seeds.push_back({"records", "run", "r" + bytes_of(folder / "run.json")});
  seeds.push_back({"records", "fruits", "f" + bytes_of(folder / "fruits.json")});
  seeds.push_back({"records", "views", "c" + bytes_of(folder / "views.csv")});
}

void add_messages(std::vector<Seed>& seeds) {
  for (const std::uint8_t type : {std::uint8_t(7), std::uint8_t(8)}) {  // float, double
    const std::uint32_t bytes = type == 7 ? 4 : 8, step = 3 * bytes + 4;
    std::string cloud(1, 'd');
    put<std::uint32_t>(cloud, {2, 2, step, 2 * step + 5});
    put<std::uint8_t>(cloud, {0, 4});
    for (std::uint8_t axis = 0; axis < 4; ++axis) {
      put<std::uint8_t>(cloud, {axis});
      put<std::uint32_t>(cloud, {axis * bytes});
      put<std::uint8_t>(cloud, {axis < 3 ? type : std::uint8_t(7), 1});
    }
    for (std::uint32_t i = 0; i < 4 * step + 10; ++i) put<std::uint8_t>(cloud, {static_cast<std::uint8_t>(7 * i)});
    seeds.push_back({"messages", type == 7 ? "cloud_float" : "cloud_double", cloud});
  }
  for (const std::uint8_t kind : {std::uint8_t(2), std::uint8_t(4), std::uint8_t(255 - 2)}) {
    std::string image(1, 'i');
    put<std::uint32_t>(image, {3, 2, 12});
    put<std::uint8_t>(image, {kind});
    for (std::uint8_t i = 0; i < 80; ++i) put<std::uint8_t>(image, {i});
    seeds.push_back({"messages", "image_" + std::to_string(kind), image});
  }
}

}  // namespace

Mesh seed_mesh() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

std::vector<Seed> make_seeds() {
  std::vector<Seed> seeds;
  const fs::path folder = scratch() / "seeds";
  fs::create_directories(folder);
  add_clouds(seeds, folder);
  add_tables(seeds);
  add_depth(seeds, folder);
  add_mcap(seeds, folder);
  add_meshes(seeds, folder);
  add_texts(seeds, folder);
  add_messages(seeds);
  return seeds;
}

}  // namespace agrisee::fuzz
