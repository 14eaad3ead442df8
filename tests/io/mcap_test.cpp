// SPDX-License-Identifier: BSD-3-Clause
// Scans as MCAP files; tests/mcap asks Foxglove's own libraries what they say of them.
#include <agrisee/io/cloud_file.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/mcap.hpp>

#include <cstring>
#include <filesystem>

#include "catch.hpp"
#include "io/formats/cdr.hpp"
#include "io/io_support.hpp"
#include "io/results/transform_tree.hpp"

using namespace agrisee;

namespace {

/// A view with depths that tell its number.
io::ViewRecord mcap_view(std::size_t i) {
  io::ViewRecord record;
  record.frame.intrinsics = {4, 3, 10.0, 11.0, 1.5, 1.0};
  record.frame.depth.assign(12, 0.3f + 0.1f * static_cast<float>(i));
  record.frame.depth[5] = 0.0f;
  record.world_T_optical.translation() = Eigen::Vector3d(0.1 * static_cast<double>(i), -0.2, 0.3);
  record.world_T_optical.linear() =
      Eigen::AngleAxisd(0.3 * static_cast<double>(i), Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  return record;
}

void write_three_views(const std::filesystem::path& path) {
  Workcell cell;
  cell.name = "cell";
  cell.scan_volume.min = {-1, -2, -3};
  cell.scan_volume.max = {1, 2, 3.5};
  cell.world_T_base.translation() = Eigen::Vector3d(0.5, 0, 0.1);
  ScanResult result;
  result.cloud.points = {{1, 2, 3}, {4, 5, 6}};
  result.labels = {0, 1};
  io::write_mcap(
      path, cell, [](std::size_t i) { return i < 3 ? std::optional(mcap_view(i)) : std::nullopt; }, result);
}

/// Write the changed bytes of an MCAP file without the checksum of its first chunk.
void write_unchecked(const std::filesystem::path& path, std::string bytes) {
  std::size_t chunk = 8;  // the first record; a head of 9 bytes holds opcode and length
  while (bytes[chunk] != 6) {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[chunk + 1], sizeof length);
    chunk += 9 + length;
  }
  bytes.replace(chunk + 9 + 24, 4, 4, '\0');  // a checksum of 0: none
  io::write_file(path, bytes);
}

}  // namespace

TEST_CASE("a scan comes back from an MCAP file as it was") {
  const test::TempFolder folder;
  const auto path = folder / "scan.mcap";
  write_three_views(path);
  const io::McapRecording recording(path);
  REQUIRE(recording.world_T_optical().size() == 3);
  CHECK(recording.warnings().empty());
  CHECK(recording.workcell().scan_volume.max == Eigen::Vector3d(1, 2, 3.5));
  CHECK(recording.workcell().world_T_base.translation() == Eigen::Vector3d(0.5, 0, 0.1));
  for (std::size_t i = 0; i < 3; ++i) {
    const io::ViewRecord view = mcap_view(i);
    CHECK(recording.frame(i).depth == view.frame.depth);
    CHECK(recording.frame(i).intrinsics.cx == 1.5);
    CHECK((recording.world_T_optical()[i].matrix() - view.world_T_optical.matrix()).cwiseAbs().maxCoeff() < 1e-15);
  }
  CHECK_THROWS_AS(recording.frame(3), InputError);
}

TEST_CASE("an MCAP file with any byte missing or wrong is an error or a recording, never a crash") {
  const test::TempFolder folder;
  const auto path = folder / "scan.mcap";
  write_three_views(path);
  const io::Bytes whole = io::read_bytes(path);
  std::size_t refused = 0, tried = 0;
  const auto look = [&](const std::string& bytes) {
    io::write_file(path, bytes);
    ++tried;
    try {
      const io::McapRecording recording(path);
      for (std::size_t i = 0; i < recording.world_T_optical().size(); ++i) recording.frame(i);
    } catch (const FileError&) {
      ++refused;
    }
  };
  for (std::size_t size = 0; size < whole.size; size += 37) look(std::string(whole.view().substr(0, size)));
  CHECK(refused > tried / 2);  // the only chunk is not whole
  for (std::size_t at = 0; at < whole.size; at += 29) {
    std::string bytes(whole.view());
    bytes[at] = static_cast<char>(bytes[at] ^ 0x81);
    look(bytes);
  }
}

TEST_CASE("a recording that is cut off before its first image, or of another format, is told of as such") {
  const test::TempFolder folder;
  const auto path = folder / "scan.mcap";
  write_three_views(path);
  const io::Bytes whole = io::read_bytes(path);
  const auto read = [](const std::filesystem::path& p) { io::McapRecording recording(p); };
  const auto cut = folder.file("cut.mcap", std::string(whole.view().substr(0, whole.size / 3)));
  test::require_file_error(cut, "is cut off before", read);
  for (const char* name : {"a.mcap", "a.bag", "a.db3"}) {
    const auto cloud = [](const std::filesystem::path& p) { io::read_cloud(p); };
    const auto bag = folder.file(std::string("1") + name, "#ROSBAG V2.0\n" + std::string(20, '\0'));
    const auto sqlite = folder.file(std::string("2") + name, "SQLite format 3" + std::string(20, '\0'));
    test::require_file_error(bag, "is a bag of ROS 1", read);
    test::require_file_error(bag, "is a bag of ROS 1", cloud);
    test::require_file_error(sqlite, "mcap convert", read);
    test::require_file_error(sqlite, "mcap convert", cloud);
  }
  test::require_file_error(folder.file("b.mcap", "#"), "is not an MCAP file", read);
  test::require_file_error(folder.file("c.mcap", ""), "is not an MCAP file", read);
}

TEST_CASE("a camera_info without focal lengths is told of as such") {
  const test::TempFolder folder;
  const auto path = folder / "scan.mcap";
  write_three_views(path);
  std::string bytes(io::read_bytes(path).view());
  const sensor::Intrinsics k = mcap_view(0).frame.intrinsics;
  for (const double value : {k.fx, k.fy})
    for (std::size_t at; (at = bytes.find(test::bytes_of(value))) != std::string::npos;)
      bytes.replace(at, sizeof value, sizeof value, '\0');
  write_unchecked(path, bytes);
  test::require_file_error(path, "has no focal length: 0 and 0",
                           [](const std::filesystem::path& p) { io::McapRecording recording(p); });
}

TEST_CASE("a camera_info with binning or a region of interest is refused, as by the ROS nodes") {
  const test::TempFolder folder;
  const auto path = folder / "scan.mcap";
  write_three_views(path);
  const std::string bytes(io::read_bytes(path).view());
  const sensor::Intrinsics k = mcap_view(0).frame.intrinsics;
  std::string end_of_p;  // binning_x and binning_y follow it, then the region: its corner, height and width
  for (const double value : {k.fy, k.cy, 0.0, 0.0, 0.0, 1.0, 0.0}) end_of_p += test::bytes_of(value);
  const auto set = [&](std::size_t number, char value) {
    std::string changed = bytes;
    for (std::size_t at = 0; (at = changed.find(end_of_p, at)) != std::string::npos;)
      changed[(at += end_of_p.size()) + 4 * number] = value;
    REQUIRE(changed != bytes);
    write_unchecked(path, changed);
  };
  const auto read = [](const std::filesystem::path& p) { io::McapRecording recording(p); };
  set(0, 1);
  CHECK_NOTHROW(read(path));
  set(1, 2);
  test::require_file_error(path, "the camera of /depth/image: CameraInfo: binning is not supported", read);
  set(4, 3);
  CHECK_NOTHROW(read(path));  // as high as the image
  set(4, 2);
  test::require_file_error(path, "a region of interest is not supported", read);
  set(3, 1);
  test::require_file_error(path, "a region of interest is not supported", read);
}

TEST_CASE("poses between transforms are interpolated along the chain of frames") {
  io::ros::TransformTree tree;
  const auto add = [&](const char* frame, const char* child, std::uint64_t time, double x, bool is_static) {
    io::ros::Transform t;
    t.header = {time, frame};
    t.child = child;
    t.pose.translation().x() = x;
    tree.add(t, is_static);
  };
  constexpr std::uint64_t kMs = 1000000;
  add("world", "arm", 1400 * kMs, 3.0, false);
  add("world", "arm", 1000 * kMs, 1.0, false);
  add("world", "arm", 3000 * kMs, 9.0, false);
  add("arm", "camera", 0, 0.5, true);
  tree.finish();
  const auto x = [&](std::uint64_t ms, bool between = false) {
    const auto pose = tree.pose("world", "camera", ms * kMs, between);
    return pose ? pose->translation().x() : -1.0;
  };
  CHECK(x(1000) == 1.5);
  CHECK(x(1100) == Approx(2.0));
  CHECK(x(900) == 1.5);         // 0.1 s before the first
  CHECK(x(900, true) == -1.0);  // where only what lies between counts
  CHECK(x(700) == -1.0);        // too early
  CHECK(x(2000) == -1.0);       // transforms 1.6 s apart
  CHECK(x(3000) == 9.5);
  CHECK(x(3100) == -1.0);  // behind the last, which is far from the one before: it may be moving
  add("world", "arm", 2600 * kMs, 9.0, false);
  tree.finish();
  CHECK(x(3100) == 9.5);
  CHECK(x(3300) == -1.0);
  CHECK(x(2500) == -1.0);
  CHECK_FALSE(tree.pose("map", "camera", 1000 * kMs));
  CHECK(tree.chain("camera") == std::vector<std::string>{"camera", "arm", "world"});
}

TEST_CASE("CDR aligns values to their size") {
  io::CdrWriter out;
  out.put(std::uint8_t{7}).put(2.5).text("ab").put(std::uint32_t{9});
  // 4 bytes of head; 1, 7 of padding, 8; 4 + 3, 1 of padding; 4
  REQUIRE(out.str().size() == 4 + 8 + 8 + 8 + 4);
  io::CdrReader in(out.str());
  CHECK(in.take<std::uint8_t>() == 7);
  CHECK(in.take<double>() == 2.5);
  CHECK(in.text() == "ab");
  CHECK(in.take<std::uint32_t>() == 9);
  CHECK_THROWS_AS(in.take<std::uint8_t>(), InputError);
  CHECK_THROWS_AS(io::CdrReader(std::string_view("\0\0\0\0", 4)), InputError);
}
