// SPDX-License-Identifier: BSD-3-Clause
// Unknown voxels, in which more fruit may be hidden: which there are, what each counts, and which of them a view shows.
// Coordinates are sums of powers of two, so that borders are met exactly.
#include <agrisee/plan/expected_surface.hpp>

#include <algorithm>
#include <numeric>

#include "plan/plan_cases.hpp"

using namespace cases;

namespace unknown_space_test {

namespace {

constexpr double kVoxel = 1.0 / 64, kArea = 0x1p-10;  // edge (m), and the fruit it stands for (m2)
const Vector3d kFar(0.0, 5.0, 0.0);

ExpectedSurfaceParameters parameters() {
  ExpectedSurfaceParameters p;
  p.voxel = kVoxel;
  p.neighborhood = 100.0;
  p.elsewhere = 0.0;
  p.unknown_weight = 4.0;
  return p;
}

Scan scan_of(const std::vector<Vector3d>& points) {
  Scan scan;
  for (const Vector3d& p : points) scan.add_point(p);
  return scan;
}

ExpectedSurface model_of(const Scan& scan, const Aabb& volume, const ExpectedSurfaceParameters& p = parameters(),
                         const sensor::DepthCamera& sensor = camera()) {
  ExpectedSurface model(sensor, volume, p);
  model.update(scan.progress(), {}, {});
  return model;
}

/// A camera that looks along +y and sees the origin at (x, y, z) of its optical frame.
Pose sees_origin_at(double x, double y, double z) { return look_along({-x, -z, y}, Vector3d::UnitY()); }

/// Whether one unknown voxel at the origin is shown where it lies at (x, y, z) of the optical frame.
bool shown_at(double x, double y, double z, const sensor::DepthCamera& sensor = camera()) {
  const ExpectedSurface model = model_of(scan_of({kFar}), box(Vector3d::Zero(), kVoxel / 2), parameters(), sensor);
  REQUIRE(model.areas() == std::vector<float>{float(kArea)});
  const Pose pose = sees_origin_at(x, y, z);
  const double gain = gain_of(model, pose);
  CHECK(gain == (model.shown(pose).empty() ? 0.0 : kArea));
  return gain > 0.0;
}

/// Whether points of the cloud hide a voxel at (1/512, 1/512, 1/2) of the optical frame: the middle of a pixel. The
/// points are in units of the voxel's ray's directions: (pixels to the right, pixels down, depth in m).
bool hidden_by(const std::vector<Vector3d>& obstacles, double column = 96.5, double row = 72.5) {
  const Pose pose = sees_origin_at((column - 96.0) / 256, (row - 72.0) / 256, 0.5);
  std::vector<Vector3d> points{kFar};
  for (const Vector3d& o : obstacles)
    points.push_back(pose * Vector3d((column - 96.0 + o.x()) / 128 * o.z(), (row - 72.0 + o.y()) / 128 * o.z(), o.z()));
  return model_of(scan_of(points), box(Vector3d::Zero(), kVoxel / 2)).shown(pose).empty();
}

}  // namespace

TEST_CASE("unknown space: a voxel is shown inside the image, its left and upper border included") {
  CHECK(shown_at(0, 0, 1));
  CHECK(shown_at(-0.75, 0, 1));
  CHECK_FALSE(shown_at(-0.7505, 0, 1));
  CHECK(shown_at(0.7495, 0, 1));
  CHECK_FALSE(shown_at(0.75, 0, 1));
  CHECK(shown_at(0, -0.5625, 1));
  CHECK_FALSE(shown_at(0, -0.563, 1));
  CHECK(shown_at(0, 0.562, 1));
  CHECK_FALSE(shown_at(0, 0.5625, 1));
  CHECK(shown_at(-0.375, -0.28125, 0.5));
  CHECK_FALSE(shown_at(0, 0, -1));  // behind the camera
}

TEST_CASE("unknown space: the image may have any size and pixels of any shape") {
  sensor::DepthCamera wide = camera();
  wide.intrinsics = {192, 36, 128.0, 32.0, 95.5, 17.5};
  CHECK(shown_at(-0.75, 0, 1, wide));
  CHECK_FALSE(shown_at(-0.7505, 0, 1, wide));
  CHECK_FALSE(shown_at(0.75, 0, 1, wide));
  CHECK(shown_at(0.7495, 0, 1, wide));
  CHECK(shown_at(0, -0.5625, 1, wide));
  CHECK_FALSE(shown_at(0, -0.563, 1, wide));
  CHECK_FALSE(shown_at(0, 0.5625, 1, wide));
  CHECK(shown_at(0, 0.562, 1, wide));
}

TEST_CASE("unknown space: a voxel is shown within the sensor's range, which is measured along the ray") {
  sensor::DepthCamera near_and_far = camera();
  near_and_far.range_min = 0.25;
  near_and_far.range_max = 1.0;
  CHECK(shown_at(0, 0, 0.25, near_and_far));
  CHECK_FALSE(shown_at(0, 0, 0.2499, near_and_far));
  CHECK(shown_at(0, 0, 1.0, near_and_far));
  CHECK_FALSE(shown_at(0, 0, 1.001, near_and_far));
  CHECK(shown_at(0.125, 0, 0.24, near_and_far));        // 0.27 m
  CHECK_FALSE(shown_at(0.5, 0, 0.9375, near_and_far));  // 1.06 m
}

TEST_CASE("unknown space: a point more than 12 mm in front hides what is within a pixel's width of it") {
  CHECK_FALSE(hidden_by({}));
  CHECK(hidden_by({{0, 0, 0.25}}));
  CHECK(hidden_by({{0, 0, 0.485}}));
  CHECK_FALSE(hidden_by({{0, 0, 0.489}}));
  CHECK_FALSE(hidden_by({{0, 0, 0.505}}));
  CHECK_FALSE(hidden_by({{0, 0, 0.75}}));
  CHECK_FALSE(hidden_by({{0, 0, -0.25}}));
  // A voxel at three quarters of pixel 96: pixels 96 and 97 are about it; at a quarter: 95 and 96.
  for (const auto& [offset, hides] : {std::pair(-0.8, false), {-0.7, true}, {1.2, true}, {1.3, false}}) {
    CHECK(hidden_by({{offset, 0, 0.25}}, 96.75, 72.5) == hides);
    CHECK(hidden_by({{0, offset, 0.25}}, 96.5, 72.75) == hides);
    CHECK(hidden_by({{-offset, 0, 0.25}}, 96.25, 72.5) == hides);
    CHECK(hidden_by({{0, -offset, 0.25}}, 96.5, 72.25) == hides);
  }
  CHECK(hidden_by({{0, 0, 0.25}, {0, 0, 0.45}}));  // the nearest counts
  CHECK(hidden_by({{0, 0, 0.75}, {0, 0, 0.25}}));
}

TEST_CASE("unknown space: points hide what is in the first and in the last pixel, points outside the image nothing") {
  CHECK_FALSE(hidden_by({}, 0.4, 0.4));
  CHECK(hidden_by({{0, 0, 0.25}}, 0.4, 0.4));
  CHECK_FALSE(hidden_by({{1, 0, 0.25}}, 0.4, 0.4));
  CHECK(hidden_by({{0, 0, 0.25}}, 191.6, 143.6));
  CHECK_FALSE(hidden_by({{1, 0, 0.25}}, 191.6, 71.6));  // the pixel to the right would be the first of the next row
  CHECK_FALSE(hidden_by({{-192, 1, 0.25}}, 191.6, 71.6));
}

TEST_CASE("unknown space: points of a cell of 3 mm count as one in their middle") {
  const Pose pose = look_along({-1.0 / 512, -0.5, 1.0 / 512}, Vector3d::UnitY());  // at 0.25 m a pixel is 2 mm
  const auto hides = [&](const std::vector<Vector3d>& points) {
    return model_of(scan_of(points), box(Vector3d::Zero(), kVoxel / 2)).shown(pose).empty();
  };
  const Vector3d in(-0.0012, -0.25, 0.001), out(-0.0029, -0.25, 0.001), farther_out(-0.0042, -0.25, 0.001);
  CHECK(hides({in, kFar}));
  CHECK_FALSE(hides({out, kFar}));
  CHECK_FALSE(hides({in, out, kFar}));
  CHECK(hides({in, farther_out, kFar}));
}

TEST_CASE("unknown space: without fruit, voxels nearer to the cloud than the neighborhood count") {
  ExpectedSurfaceParameters p = parameters();
  p.neighborhood = 3 * kVoxel;
  Aabb volume;
  volume.min = {-0.25, 0.5, 0.0};
  volume.max = volume.min + Vector3d::Constant(8 * kVoxel);
  const Vector3d middle = volume.min + Vector3d::Constant(4.5 * kVoxel);
  // Of the points of a lattice, 93 are nearer than 3 to the origin, 30 more are 3 away.
  ExpectedSurface model = model_of(scan_of({middle}), volume, p);
  CHECK(model.areas() == std::vector<float>(93, float(kArea)));
  model = model_of(scan_of({middle, middle - Vector3d(kVoxel, 0, 0)}), volume, p);
  CHECK(model.areas().size() == 93 + 25);  // the layer through the middle (y^2 + z^2 < 9) counts twice
  p.elsewhere = 0.25;                      // of the 419 others one in eight counts for all of them
  const std::vector<float> areas = model_of(scan_of({middle}), volume, p).areas();
  CHECK(std::count(areas.begin(), areas.end(), float(kArea)) == 93);
  CHECK(std::count(areas.begin(), areas.end(), float(8 * 0.25 * kArea)) == 53);
  CHECK(areas.size() == 93 + 53);
  p.neighborhood = 100.0;
  CHECK(model_of(scan_of({middle}), volume, p).areas().size() == 512);
  CHECK(model.bodies().empty());
  CHECK(model.area() == 0.0);
}

TEST_CASE("unknown space: an unknown voxel counts with its weight") {
  ExpectedSurfaceParameters p = parameters();
  p.unknown_weight = 0.08;
  p.voxel = 0.02;
  const ExpectedSurface model = model_of(scan_of({kFar}), box(Vector3d::Zero(), 0.01), p);
  REQUIRE(model.areas().size() == 1);
  CHECK(model.areas()[0] == Approx(3.2e-5));
}

TEST_CASE("unknown space: samples are in the order of the voxels, by z, then y, then x") {
  Aabb volume;
  volume.min = Vector3d::Zero();
  volume.max = {4 * kVoxel, 2 * kVoxel, 2 * kVoxel};
  const ExpectedSurface model = model_of(scan_of({kFar}), volume);
  REQUIRE(model.areas().size() == 16);
  // With so narrow an image a view along y shows the voxels of one column: y = 0 and y = 1.
  const auto shown_from = [&](const Vector3d& voxel) {
    ExpectedSurface narrow = model_of(scan_of({kFar}), volume, parameters(), camera(4096.0));
    return narrow.shown(
        look_along(kVoxel * (voxel + Vector3d::Constant(0.5)) - Vector3d(0, 0.25, 0), Vector3d::UnitY()));
  };
  CHECK(shown_from({2, 0, 1}) == std::vector<std::uint32_t>{10, 14});
  CHECK(shown_from({0, 0, 0}) == std::vector<std::uint32_t>{0, 4});
  CHECK(shown_from({4, 0, 0}).empty());
}

TEST_CASE("unknown space: sight lines make known what they went through and where they ended") {
  Aabb volume;
  volume.min = {-4 * kVoxel, 0.0, -4 * kVoxel};
  volume.max = {4 * kVoxel, 8 * kVoxel, 4 * kVoxel};
  Scan scan = scan_of({kFar});
  const Pose front = look_along({0, -0.5, 0}, Vector3d::UnitY());
  ExpectedSurfaceParameters p = parameters();
  ExpectedSurface model(camera(), volume, p);
  const auto left = [&] {
    model.update(scan.progress(), {}, {});
    return model.areas().size();
  };
  CHECK(left() == 512);
  scan.images.push_back(flat_image(front, 0.0, 0.0));  // no returns, and that is no evidence
  CHECK(left() == 512);
  scan.images.push_back(flat_image(front, 0.5 + 4.5 * kVoxel));  // ends in the fifth of eight layers
  CHECK(left() == 3 * 64);
  // The rest should have been shown by both images, and was not; the one that measured nothing counts a quarter.
  CHECK(model.areas()[0] == Approx(kArea * (1.0 - 0.25 * (1.0 - p.missed_factor)) * p.missed_factor));
  scan.images[0] = flat_image(front, 0.0, 1.0);  // each image is read once
  CHECK(left() == 3 * 64);
  scan.images.push_back(flat_image(look_along({0, 1.0, 0}, -Vector3d::UnitY()), 1.0 - 6.5 * kVoxel));
  CHECK(left() == 64);                                 // from behind, two layers more
  scan.images.push_back(flat_image(front, 0.0, 1.0));  // no returns: free space
  CHECK(left() == 0);
  CHECK(gain_of(model, front) == 0.0);
}

TEST_CASE("unknown space: voxels of a large volume are enlarged until there are at most two million") {
  ExpectedSurfaceParameters p = parameters();
  p.neighborhood = 0.1;
  SECTION("two million are not too many, and a flat volume has one layer") {
    p.voxel = 1.0 / 16;
    Aabb volume;
    volume.min = Vector3d::Zero();
    volume.max = {1600.0 / 16, 1250.0 / 16, 0.0};
    const ExpectedSurface model = model_of(scan_of({{50 + 1.0 / 32, 40 + 1.0 / 32, 1.0 / 32}}), volume, p);
    CHECK(model.areas() == std::vector<float>(9, float(4.0 / 256)));
  }
  SECTION("somewhat more are") {
    p.voxel = 0.015;
    const ExpectedSurface model = model_of(scan_of({{1, 1, 1}}), box({1, 1, 1}, 1.05), p);
    CHECK(model.areas().at(0) == Approx(4.0 * 0.0195 * 0.0195));
  }
  SECTION("many more are enlarged twice") {
    p.voxel = 0.015;
    const ExpectedSurface model = model_of(scan_of({{1, 1, 1}}), box({1, 1, 1}, 1.5), p);
    CHECK(model.areas().at(0) == Approx(4.0 * 0.02535 * 0.02535));
  }
}

TEST_CASE("unknown space: the point to look at is the middle of the cloud, without a cloud that of the volume") {
  const Aabb volume = box({1, 2, 3}, 0.5);
  ExpectedSurface model(camera(), volume, parameters());
  CHECK(model.area() == 0.0);
  CHECK(model.covered_area() == 0.0);
  CHECK(gain_of(model, Pose::Identity()) == 0.0);
  model.update(Scan().progress(), {}, {});
  CHECK(model.center() == volume.center());
  CHECK(model.extent().min == volume.min);
  CHECK(model.extent().max == volume.max);
  CHECK(model.areas().empty());
  model.update(scan_of({{1, 2, 3}, {1.25, 2.5, 3}, {1, 2, 3.125}}).progress(), {}, {});
  CHECK(model.center() == Vector3d(1.125, 2.25, 3.0625));
  CHECK(model.extent().min == Vector3d(1, 2, 3));
  CHECK(model.extent().max == Vector3d(1.25, 2.5, 3.125));
  const Completeness none = model.completeness(std::vector<char>(model.areas().size(), 1));
  CHECK(none.fruits.empty());
  CHECK(none.seen == 0.0);
  CHECK(none.observable == 0.0);
}

TEST_CASE("unknown space: parameters out of their range are refused") {
  const auto refused = [](auto&& change) {
    ExpectedSurfaceParameters p;
    change(p);
    CHECK_THROWS_AS(ExpectedSurface(camera(), box(Vector3d::Zero(), 0.1), p), ParameterError);
  };
  refused([](auto& p) { p.voxel = 0.0; });
  refused([](auto& p) { p.samples = 0; });
  refused([](auto& p) { p.missed_factor = 1.1; });
}

TEST_CASE("unknown voxels: when the map starts again, only the sight lines of its views count") {
  const Aabb volume = box(Vector3d::Zero(), 4 * kVoxel);
  Scan scan = scan_of({kFar});
  const Pose front = sees_origin_at(0.0, 0.0, 0.5), above = look_along({0.0, 0.0, 0.5}, -Vector3d::UnitZ());
  const auto start_again = [&] {  // the first view is discarded, the second one taken in
    scan.images = {{}, flat_image(above, 0.5)};
    scan.images[0].world_T_optical = front;
  };
  start_again();
  const std::size_t at_once = model_of(scan, volume).areas().size();
  REQUIRE(at_once > 0);
  REQUIRE(at_once < 512);

  scan.images = {flat_image(front, 0.48), {}};
  ExpectedSurface model = model_of(scan, volume);
  const std::size_t before = model.areas().size();
  CHECK(before != at_once);
  model.update(scan.progress(), {}, {});  // nothing new
  CHECK(model.areas().size() == before);
  start_again();
  model.update(scan.progress(), {}, {});
  CHECK(model.areas().size() == at_once);
}

}  // namespace unknown_space_test
