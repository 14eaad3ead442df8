// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/scan_record.hpp>

#include <cstring>
#include <limits>

#include "io_support.hpp"

using namespace agrisee;
using test::require_file_error;

namespace {

io::ViewRecord record_of(std::vector<float> depth) {
  io::ViewRecord record;
  record.frame.intrinsics = {4, 2, 10.0, 11.0, 1.5, 0.5};
  record.frame.depth = std::move(depth);
  record.world_T_optical_asked = pose_from_xyz_rpy({0.1, -0.2, 1.0 / 3.0}, {0.3, -0.1, 2.0});
  record.world_T_optical = record.world_T_optical_asked * Eigen::Translation3d(1e-4, 0.0, -1e-9);
  return record;
}

}  // namespace

TEST_CASE("a recorded view is read back bit by bit") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const test::TempFolder folder;
  std::size_t number = 0;
  for (const std::vector<float>& depth : {std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0},
                                          {1, 2, 3, 4, 5, 6, 7, 8},
                                          {0, 0, 1.5f, 0, nan, -1, -0.0f, inf},
                                          {1e-40f, 0, 0, 0, 0, 0, 0, 2}}) {
    io::ViewRecord record = record_of(depth);
    if (number % 2) record.joints = (Joints() << 0.1, -1.0 / 3.0, 2, 3, 4, 5e-17).finished();
    io::write_view_record(folder.path(), number, record, "scan");
    const auto read = io::read_view_record(folder.path(), number, "scan", 8);
    REQUIRE(read);
    CHECK(std::memcmp(read->frame.depth.data(), depth.data(), depth.size() * sizeof(float)) == 0);
    CHECK(read->world_T_optical_asked.matrix() == record.world_T_optical_asked.matrix());
    CHECK(read->world_T_optical.matrix() == record.world_T_optical.matrix());
    CHECK(read->joints == record.joints);
    CHECK(read->frame.intrinsics.fy == 11.0);
    ++number;
  }
  CHECK_FALSE(io::read_view_record(folder.path(), number, "scan", 8));
}

TEST_CASE("a record that is damaged, or of something else, is refused") {
  const test::TempFolder folder;
  io::write_view_record(folder.path(), 7, record_of({0, 1, 2, 3, 0, 0, 4, 0}), "scan");
  const auto path = io::view_record_path(folder.path(), 7);
  CHECK(path.filename() == "0007.view");
  const std::string whole = test::slurp(path);
  const auto read = [&](const std::string& scan, std::size_t pixels) {
    return [&folder, scan, pixels](const auto&) { io::read_view_record(folder.path(), 7, scan, pixels); };
  };
  require_file_error(path, "another scan", read("other", 8));
  require_file_error(path, "9 pixels", read("scan", 9));
  for (std::size_t n = 0; n < whole.size(); ++n) {
    io::write_file(path, whole.substr(0, n));
    require_file_error(path, "", read("scan", 8));
    std::string changed = whole;
    changed[n] = static_cast<char>(changed[n] ^ 4);
    io::write_file(path, changed);
    require_file_error(path, "", read("scan", 8));
  }
  io::write_file(io::view_record_path(folder.path(), 8), whole);
  require_file_error(io::view_record_path(folder.path(), 8), "another view",
                     [&](const auto&) { io::read_view_record(folder.path(), 8, "scan", 8); });
}

TEST_CASE("what a scan was asked for is read back, and its fingerprint tells scans apart") {
  const test::TempFolder folder;
  io::ScanTask task;
  task.scene = "/a/scene.yaml";
  task.content = "0123";
  task.version = "1.2.3";
  task.seed = 18446744073709551615u;
  task.threads = 3;
  task.noise = "gaussian:0.01";
  task.planner = "greedy";
  task.parameters = Parameters::paper();
  task.parameters.sor.std_ratio = 1.0 / 3.0;
  task.parameters.icp.kernel = RobustKernel::huber;
  io::write_scan_task(folder / "scan.json", task);
  const io::ScanTask read = io::read_scan_task(folder / "scan.json");
  CHECK(read.scene == task.scene);
  CHECK(read.threads == 3);
  CHECK(read.fingerprint() == task.fingerprint());
  io::ScanTask other = task;
  other.scene = "/b/scene.yaml";
  other.threads = 1;
  CHECK(other.fingerprint() == task.fingerprint());
  for (int change = 0; change < 5; ++change) {
    other = task;
    if (change == 0) other.content = "0124";
    if (change == 1) other.seed = 1;
    if (change == 2) other.noise = "none";
    if (change == 3) other.planner = "gain";
    if (change == 4) other.parameters.max_views = 7;
    CHECK(other.fingerprint() != task.fingerprint());
  }
  require_file_error(folder.file("bad.json", "{\"format_version\": 2}"), "only version 1",
                     [](const auto& path) { io::read_scan_task(path); });
}

TEST_CASE("leftovers and records are removed, other files stay") {
  const test::TempFolder folder;
  folder.file("scan.json", "{}");
  folder.file(".cloud.ply.tmp123-4", "x");
  folder.file(".mine.tmp", "x");
  std::filesystem::create_directory(folder / "views");
  folder.file("views/0000.view", "x");
  folder.file("views/notes.txt", "x");
  io::remove_leftovers(folder.path());
  CHECK_FALSE(std::filesystem::exists(folder / ".cloud.ply.tmp123-4"));
  CHECK(std::filesystem::exists(folder / ".mine.tmp"));
  io::remove_scan_records(folder.path());
  CHECK_FALSE(std::filesystem::exists(folder / "scan.json"));
  CHECK_FALSE(std::filesystem::exists(folder / "views/0000.view"));
  CHECK(std::filesystem::exists(folder / "views/notes.txt"));
}
