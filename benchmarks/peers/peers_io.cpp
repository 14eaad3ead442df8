// SPDX-License-Identifier: BSD-3-Clause
// Binary PLY clouds with normals written and read, STL meshes read; from the page cache, so parsing is measured, not
// the disk.
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/ply.hpp>

#ifdef PEERS_PCL
#include <pcl/io/ply_io.h>
#endif
#ifdef PEERS_OPEN3D
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/io/PointCloudIO.h>
#include <open3d/io/TriangleMeshIO.h>
#endif

#include <filesystem>
#include <unistd.h>

#include "../../tests/support/shapes.hpp"
#include "conversions.hpp"

using namespace agrisee;

namespace {

std::filesystem::path temporary(const std::string& name) {
  static const std::filesystem::path folder = [] {
    const auto path = std::filesystem::temp_directory_path() / ("agrisee_peers_" + std::to_string(::getpid()));
    std::filesystem::create_directory(path);
    return path;
  }();
  return folder / name;
}

std::filesystem::path written(std::size_t n) {
  const auto path = temporary("read_" + std::to_string(n) + ".ply");
  if (!std::filesystem::exists(path)) io::write_ply(path, peers::cloud(n));
  return path;
}

#ifdef PEERS_PCL
const pcl::PointCloud<pcl::PointNormal>& pcl_with_normals(std::size_t n) {
  static std::map<std::size_t, pcl::PointCloud<pcl::PointNormal>> clouds;
  auto& c = clouds[n];
  if (c.empty())
    for (std::size_t i = 0; i < n; ++i) {
      const auto& p = peers::cloud(n).points[i];
      const auto& v = peers::cloud(n).normals[i];
      c.emplace_back(p.x(), p.y(), p.z(), v.x(), v.y(), v.z());
    }
  return c;
}
#endif

void ply(std::size_t n) {
  const Cloud& cloud = peers::cloud(n);
  peers::add(
      "ply_read", "ours", n, 1, [=](int) { return io::read_ply(written(n)); },
      [&](const auto& file) { peers::require(file.cloud.points == cloud.points, "PLY read"); });
  const auto out = temporary("write.ply");
  peers::add(
      "ply_write", "ours", n, 1, [=](int) { return io::write_ply(out, peers::cloud(n)), 0; }, peers::Unchecked());
#ifdef PEERS_PCL
  peers::add(
      "ply_read", "PCL", n, 1,
      [=](int) {
        pcl::PointCloud<pcl::PointNormal> in;
        pcl::PLYReader().read(written(n).string(), in);
        return in;
      },
      [&](const auto& in) {
        peers::require(in.size() == cloud.size() && in.back().getVector3fMap() == cloud.points.back(),
                       "PLY read by PCL");
      });
  peers::add(
      "ply_write", "PCL", n, 1,
      [=](int) { return pcl::PLYWriter().write(out.string(), pcl_with_normals(n), true, false); }, peers::Unchecked());
#endif
#ifdef PEERS_OPEN3D
  peers::add(
      "ply_read", "Open3D", n, 1,
      [=](int) {
        open3d::geometry::PointCloud in;
        open3d::io::ReadPointCloudFromPLY(written(n).string(), in, {});
        return in;
      },
      [&](const auto& in) {
        peers::require(
            in.points_.size() == cloud.size() && in.points_.back().template cast<float>() == cloud.points.back(),
            "PLY read by Open3D");
      });
  peers::add(
      "ply_write", "Open3D", n, 1,
      [=](int) {
        auto& c = peers::open3d_cloud(n);
        if (c.normals_.empty())
          for (const auto& v : peers::cloud(n).normals) c.normals_.push_back(v.cast<double>());
        return open3d::io::WritePointCloudToPLY(out.string(), c, {});
      },
      peers::Unchecked());
#endif
}

void stl() {
  const auto path = temporary("mesh.stl");
  const Mesh mesh = shapes::sphere({0, 0, 0}, 0.1, 224);
  io::write_stl(path, mesh);
  const std::size_t n = mesh.triangles.size();
  peers::add(
      "stl_read", "ours", n, 1, [=](int) { return io::read_stl(path); },
      [=](const Mesh& m) { peers::require(m.triangles.size() == n, "STL read"); });
#ifdef PEERS_OPEN3D
  peers::add(
      "stl_read", "Open3D", n, 1,
      [=](int) {
        open3d::geometry::TriangleMesh m;
        open3d::io::ReadTriangleMesh(path.string(), m);
        return m;
      },
      [=](const auto& m) { peers::require(m.triangles_.size() == n, "STL read by Open3D"); });
#endif
}

}  // namespace

int main(int argc, char** argv) {
  for (const std::size_t n : {15000u, 150000u, 1500000u}) ply(n);
  stl();
  const int status = peers::main(argc, argv);
  std::filesystem::remove_all(temporary("").parent_path());
  return status;
}
