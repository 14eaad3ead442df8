// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/pcd.hpp>
#include <agrisee/io/ply.hpp>

#include <cstring>

#include "targets.hpp"

namespace agrisee::fuzz {
namespace {

void check_cloud(const io::CloudFile& file, bool finite) {
  const std::size_t n = file.cloud.size();
  require(file.cloud.normals.empty() || file.cloud.normals.size() == n, "one normal a point");
  require(file.cloud.views.empty() || file.cloud.views.size() == n, "one view a point");
  require(file.instance.empty() || file.instance.size() == n, "one instance a point");
  require(file.width * file.height == n, "width times height points");
  for (const auto& normal : file.cloud.normals)
    require(normal.isZero() || std::abs(normal.norm() - 1.0f) < 1e-3f, "normals are unit or zero");
  if (finite)
    for (const auto& p : file.cloud.points) require(is_finite(p), "points that are not finite are dropped");
}

/// What was read and is written is read back the same.
void check_round_trip(const io::CloudFile& file) {
  const std::filesystem::path path = scratch() / "again.ply";
  io::write_ply(path, file.cloud, file.instance);
  const io::CloudFile again = io::read_ply(path);
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
  };
  require(same(file.cloud.points, again.cloud.points), "points survive a round trip");
  if (!file.cloud.normals.empty()) require(same(file.cloud.normals, again.cloud.normals), "normals likewise");
  if (!file.instance.empty()) require(same(file.instance, again.instance), "instances likewise");
}

template <typename Read>
void read_both(const std::uint8_t* data, std::size_t size, Read&& read) {
  const std::filesystem::path path = as_file(data, size);
  attempt([&] {
    const io::CloudFile dropped = read(path, io::NonFinite::drop);
    check_cloud(dropped, true);
    const io::CloudFile kept = read(path, io::NonFinite::keep);
    check_cloud(kept, false);
    require(kept.cloud.size() == dropped.cloud.size() + dropped.dropped, "dropped points are counted");
    if (size % 16 == 0) check_round_trip(dropped);  // a disk's work: not every time
  });
}

}  // namespace

void ply(const std::uint8_t* data, std::size_t size) {
  read_both(data, size, io::read_ply);
  attempt([&] { io::read_ply_mesh(as_file(data, size)); });
}

void pcd(const std::uint8_t* data, std::size_t size) { read_both(data, size, io::read_pcd); }

void table(const std::uint8_t* data, std::size_t size) {
  read_both(data, size, io::read_cloud);
  read_both(data, size, io::read_table_cloud);
}

}  // namespace agrisee::fuzz
