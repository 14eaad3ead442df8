// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/recorded_views.hpp>

#include <array>

#include "io/io_support.hpp"

using namespace agrisee;
using namespace agrisee::test;

namespace recorded_views_test {

namespace {

const std::string kCamera = "camera: {width: 4, height: 2, fx: 5, fy: 6, cx: 1.5, cy: 0.5}\n";
const std::string kPose = "{xyz: [0, 0, 0], rpy: [0, 0, 0]}";

io::RecordedViews load(const std::filesystem::path& path) { return io::read_recorded_views(path); }

sensor::DepthFrame frame_of(float depth) {
  sensor::DepthFrame frame;
  frame.intrinsics = {4, 2, 5.0, 6.0, 1.5, 0.5};
  frame.depth.assign(8, depth);
  return frame;
}

/// views.yaml with one view, d.npy (0.5 m everywhere), from this pose.
std::filesystem::path one_view(const TempFolder& folder, const std::string& pose, const std::string& more = "") {
  io::write_depth_npy(folder / "d.npy", frame_of(0.5f));
  return folder.file("views.yaml", kCamera + "views:\n  - depth: d.npy\n    pose: " + pose + "\n" + more);
}

}  // namespace

TEST_CASE("recorded views: camera, files and poses in every form") {
  const TempFolder folder;
  io::write_depth_npy(folder / "a.npy", frame_of(0.5f));
  io::write_depth_png(folder / "b.png", frame_of(0.5f));
  const auto path =
      folder.file("views.yaml",
                  "name: row 3\n"
                  "camera: {width: 4, height: 2, fx: 5, fy: 6, cx: 1.5, cy: 0.5, range: [0.2, 2]}\n"
                  "base: {xyz: [0, -1, 0], rpy: [0, 0, 0]}\n"
                  "scan_volume: {min: [-1, -1, 0], max: [1, 1, 2]}\n"
                  "views:\n"
                  "  - {depth: a.npy, pose: [[0, 0, 1, 7], [-1, 0, 0, 8], [0, -1, 0, 9], [0, 0, 0, 1]]}\n"
                  "  - depth: b.png\n"
                  "    pose: {xyz: [1, 2, 3], rpy: [0.1, 0.2, 0.3]}\n"
                  "  - {depth: " +
                      (folder / "a.npy").string() + ", pose: {xyz: [1, 2, 3], quaternion: [0, 0, 0.6, 0.8]}}\n");
  const io::RecordedViews recorded = io::read_recorded_views(path);
  CHECK(recorded.workcell.name == "row 3");
  CHECK(recorded.workcell.sensor.intrinsics.fx == 5.0);
  CHECK(recorded.workcell.sensor.intrinsics.cy == 0.5);
  CHECK(recorded.workcell.world_T_base.translation() == Eigen::Vector3d(0, -1, 0));
  CHECK(recorded.workcell.scan_volume.max == Eigen::Vector3d(1, 1, 2));
  CHECK_FALSE(recorded.depth_scale);
  REQUIRE(recorded.views.size() == 3);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  CHECK((recorded.views[0].world_T_optical * x).isApprox(Eigen::Vector3d(7, 7, 9)));
  CHECK(recorded.views[1].world_T_optical.isApprox(pose_from_xyz_rpy({1, 2, 3}, {0.1, 0.2, 0.3})));
  CHECK((recorded.views[2].world_T_optical * x).isApprox(Eigen::Vector3d(1.28, 2.96, 3)));
  for (std::size_t i = 0; i < 3; ++i)
    for (const float z : io::read_frame(recorded, i).depth) CHECK(z == Approx(0.5f));
  CHECK(recorded.warnings.empty());
}

TEST_CASE("recorded views are read back as they were written") {
  const TempFolder folder;
  io::write_depth_npy(folder / "a b.npy", frame_of(0.5f));
  io::RecordedViews recorded;
  recorded.workcell.name = "it's \"one\": #2";
  recorded.workcell.sensor.intrinsics = {4, 2, 5.0 / 3.0, 6.0, 1.5, 0.5};
  recorded.workcell.sensor.range_max = 3.5;
  recorded.workcell.world_T_base = pose_from_xyz_rpy({0.1, 0.2, 1.0 / 3.0}, {1, 2, 3});
  recorded.workcell.scan_volume.extend(Eigen::Vector3d(-0.1, 0.4, 0.0));
  recorded.workcell.scan_volume.extend(Eigen::Vector3d(0.1, 0.6, 1.0 / 3.0));
  recorded.depth_scale = 1.0;
  recorded.views.push_back({"a b.npy", pose_from_xyz_rpy({0, 0, 0.7}, {0.3, -0.4, 2.5}), ""});
  io::write_recorded_views(folder / "views.yaml", recorded);
  const io::RecordedViews again = io::read_recorded_views(folder / "views.yaml");
  CHECK(again.workcell.name == recorded.workcell.name);
  CHECK(again.workcell.sensor.intrinsics.fx == 5.0 / 3.0);
  CHECK(again.workcell.sensor.range_max == 3.5);
  CHECK(again.workcell.world_T_base.matrix() == recorded.workcell.world_T_base.matrix());
  CHECK(again.workcell.scan_volume.max == recorded.workcell.scan_volume.max);
  CHECK(again.depth_scale == recorded.depth_scale);
  REQUIRE(again.views.size() == 1);
  CHECK(again.views[0].world_T_optical.matrix() == recorded.views[0].world_T_optical.matrix());
  CHECK(io::read_frame(again, 0).depth == frame_of(0.5f).depth);
  recorded.views[0].world_T_optical.linear() *= 1.1;
  CHECK_THROWS_AS(io::write_recorded_views(folder / "views.yaml", recorded), InputError);
}

TEST_CASE("rotations that a tool rounded are made exact, others are refused") {
  const TempFolder folder;
  const io::RecordedViews recorded = io::read_recorded_views(
      one_view(folder, "[[0.8660, -0.5, 0, 1], [0.5, 0.8660, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]"));
  CHECK(is_rigid(recorded.views[0].world_T_optical));
  REQUIRE(recorded.warnings.size() == 1);
  CHECK(recorded.warnings[0].find("views[0].pose: its rotation matrix was off by 1.9e-05") == 0);
  CHECK(angle_of(recorded.views[0].world_T_optical) == Approx(kPi / 6.0).epsilon(1e-4));
  const auto refused = [&](const std::string& pose, const std::string& what) {
    require_file_error(one_view(folder, pose), what, load);
  };
  refused("[[0.87, -0.5, 0, 1], [0.5, 0.87, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]", ":4: views[0].pose: is not a rigid");
  refused("[[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, -1, 3], [0, 0, 0, 1]]", "left-handed");
  refused("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]]", "Is it transposed?");
  refused("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, .nan, 0]]", "is not a number");
  refused("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1]]", "4 numbers");
  refused("[1, 0, 0, 0]", "expected a list");
  refused("{xyz: [0, 0, 0], quaternion: [0, 0, 0, 2]}", "the length of its quaternion is off by 1 ");
  refused("{xyz: [0, 0, 0]}", "missing key 'rpy'");
  refused("{xyz: [0, 0], rpy: [0, 0, 0]}", "views[0].pose.xyz: expected a list of 3 numbers");
  refused("{xyz: [0, 0, nan], rpy: [0, 0, 0]}", "must be finite");
}

TEST_CASE("a bad views.yaml is refused with line and key") {
  const TempFolder folder;
  const auto refused = [&](const std::string& text, const std::string& what) {
    require_file_error(folder.file("views.yaml", text), what, load);
  };
  refused("", "is empty");
  refused("views: []\n", "missing key 'camera'");
  refused(kCamera, "missing key 'views'");
  refused(kCamera + "views: []\n", ":2: views: expected at least one view");
  refused(kCamera + "views:\n  - {depth: no.png, pose: " + kPose + "}\n", ":3: views[0].depth: no such file: ");
  refused(kCamera + "views:\n  - {depht: no.png, pose: " + kPose + "}\n", ":3: views[0]: unknown key 'depht'");
  refused("camera: {width: 4, height: 2, fx: 5, fy: 6, cx: 1.5}\nviews: []\n", "camera: missing key 'cy'");
  refused("camera: {width: 4, height: 0, fx: 5, fy: 6, cx: 1.5, cy: 1}\nviews: []\n", "camera.height: must be from 1");
  refused("camera: {width: 4, height: 2, fx: -5, fy: 6, cx: 1.5, cy: 1}\nviews: []\n", "camera.fx: must be positive");
  refused("camera: {width: 4, height: 2, fx: 5, fy: 6, cx: 320, cy: 1}\nviews: []\n", "camera.cx: is outside");
  refused("camera: {width: 4, height: 2, fx: 5, fy: 6, cx: 1, cy: 1, depth_scale: 0}\nviews: []\n",
          "camera.depth_scale: must be positive");
  refused("camera: {width: 4, height: 2, fx: 5, fy: 6, cx: 1, cy: 1, range: [2, 1]}\nviews: []\n", "camera.range");
  require_file_error(one_view(folder, kPose, "scan_volume: {min: [0, 0, 0], max: [1, 1, 0]}\n"),
                     ":5: scan_volume: min must be below max", load);
}

TEST_CASE("depth images that do not fit the camera are refused with the view") {
  const TempFolder folder;
  const auto path = one_view(folder, kPose);
  const auto refused = [&](const std::string& what) {
    const io::RecordedViews recorded = io::read_recorded_views(path);
    require_file_error(path, what, [&](const auto&) { io::read_frame(recorded, 0); });
  };
  io::write_depth_npy(folder / "d.npy", frame_of(500.0f));  // millimetres as floats
  refused(":3: views[0].depth: ");
  refused("the median depth is 500 m: is camera.depth_scale right?");
  sensor::DepthFrame wrong = frame_of(0.5f);
  std::swap(wrong.intrinsics.width, wrong.intrinsics.height);
  io::write_depth_npy(folder / "d.npy", wrong);
  refused("has 2 x 4 pixels, but the camera 4 x 2");
  folder.file("d.npy", "damaged");
  refused("neither a PNG nor an NPY");
  std::filesystem::remove(folder / "d.npy");
  std::filesystem::create_directory(folder / "d.npy");
  refused("is a directory");
  CHECK_THROWS_AS(io::read_frame(io::read_recorded_views(path), 1), InputError);
}

TEST_CASE("depths outside of the camera's range are no returns") {
  const TempFolder folder;
  sensor::DepthFrame frame = frame_of(0.5f);
  frame.depth[0] = 0.1f;
  frame.depth[1] = 2.5f;
  io::write_depth_npy(folder / "d.npy", frame);
  const std::string ends = "}\nviews: [{depth: d.npy, pose: " + kPose + "}]\n";
  const std::string begins = kCamera.substr(0, kCamera.size() - 2);
  const auto depths = [&](const std::string& more) {
    return io::read_frame(io::read_recorded_views(folder.file("views.yaml", begins + more + ends)), 0).depth;
  };
  CHECK(depths("") == frame.depth);
  std::vector<float> expected = frame.depth;
  expected[0] = expected[1] = 0.0f;
  CHECK(depths(", range: [0.2, 2]") == expected);
  for (float& z : expected) z *= 2.0f;
  CHECK(depths(", depth_scale: 2, range: [0.5, 4]") == expected);
  CHECK(depths(", depth_scale: 2").front() == Approx(0.2f));
}

TEST_CASE("a camera's range is of distances along the rays, not of depths") {
  const TempFolder folder;
  const sensor::DepthFrame frame = frame_of(0.5f);
  io::write_depth_npy(folder / "d.npy", frame);
  const std::string ends = "}\nviews: [{depth: d.npy, pose: " + kPose + "}]\n";
  const std::string begins = kCamera.substr(0, kCamera.size() - 2);
  for (const std::string lens : {"", ", distortion: [0.1, 0, 0, 0]"}) {
    // Points at the corners are 0.524 m away, those beside the middle 0.504 m.
    const auto depths = [&](const std::string& more) {
      return io::read_frame(io::read_recorded_views(folder.file("views.yaml", begins + lens + more + ends)), 0).depth;
    };
    std::vector<float> corners = depths(""), middle = corners;
    for (const std::size_t i : {1, 2, 5, 6}) corners[i] = 0.0f;
    for (const std::size_t i : {0, 3, 4, 7}) middle[i] = 0.0f;
    CHECK(depths(", range: [0.51, 2]") == corners);
    CHECK(depths(", range: [0.2, 0.51]") == middle);
  }
}

TEST_CASE("the extent of a frame holds its points in world") {
  sensor::DepthFrame frame = frame_of(0.5f);
  frame.depth[7] = 0.0f;  // the lower right corner
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(0, 0, 2);
  const Aabb box = io::extent_of(frame, pose);
  CHECK(box.min.isApprox(Eigen::Vector3d(-0.15, -0.5 / 12.0, 2.5), 1e-6));
  CHECK(box.max.isApprox(Eigen::Vector3d(0.15, 0.5 / 12.0, 2.5), 1e-6));
  CHECK(io::extent_of(frame_of(0.0f), pose).empty());
}

TEST_CASE("recorded views: a lens's distortion is taken out, and written again") {
  const TempFolder folder;
  sensor::DepthFrame frame;
  frame.intrinsics = {40, 30, 30.0, 31.0, 19.5, 14.5};
  for (int i = 0; i < 40 * 30; ++i) frame.depth.push_back(0.5f + 0.001f * static_cast<float>(i % 40));
  io::write_depth_npy(folder / "d.npy", frame);
  const auto with = [&](const std::string& distortion) {
    return folder.file("views.yaml", "camera: {width: 40, height: 30, fx: 30, fy: 31, cx: 19.5, cy: 14.5" + distortion +
                                         "}\nviews:\n  - depth: d.npy\n    pose: " + kPose + "\n");
  };
  const io::RecordedViews recorded = load(with(", distortion: [-0.2, 0.05, 0, 0.001]"));
  const auto lens = sensor::distortion_from(std::array<double, 4>{-0.2, 0.05, 0.0, 0.001});
  const sensor::DepthFrame read = io::read_frame(recorded, 0);
  CHECK(read.depth == sensor::rectified(frame, lens).depth);
  CHECK(read.depth != frame.depth);
  io::write_recorded_views(folder / "again.yaml", recorded);
  CHECK(load(folder / "again.yaml").distortion.k == lens.k);
  CHECK_THROWS_WITH(load(with(", distortion: [1, 2]")), Catch::Contains("views.yaml:1: camera.distortion: "));
  CHECK_THROWS_WITH(load(with(", distortion: [-3, 0, 0, 0]")), Catch::Contains("folds the image"));
}

}  // namespace recorded_views_test
