// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/sensor/rectify.hpp>

#include <array>
#include <catch2/catch.hpp>
#include <vector>

using namespace agrisee;
using namespace agrisee::sensor;

namespace {

const Intrinsics kCamera{160, 120, 140.0, 141.0, 80.3, 59.2};
const Distortion kLens{{-0.12, 0.05, 0.002, -0.001, 0.01, 0.02, -0.01, 0.003}};

/// What a lens shows of a plane, z = 1 + 0.2 x - 0.1 y in the optical frame: pixel by pixel the depth on its true ray.
DepthFrame plane_seen_through(const Distortion& lens) {
  DepthFrame frame;
  frame.intrinsics = kCamera;
  for (int v = 0; v < kCamera.height; ++v)
    for (int u = 0; u < kCamera.width; ++u) {
      const Eigen::Vector2d ray = lens.undistorted(kCamera.ray(u, v).head<2>()).value();
      frame.depth.push_back(static_cast<float>(1.0 / (1.0 - 0.2 * ray.x() + 0.1 * ray.y())));
      frame.color.push_back({static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v), 7});
      frame.instances.push_back(static_cast<std::uint16_t>(1 + u / 40));
    }
  return frame;
}

}  // namespace

TEST_CASE("a lens's distortion and its inverse undo one another") {
  for (const double x : {-0.6, -0.1, 0.0, 0.3, 0.55})
    for (const double y : {-0.4, 0.05, 0.41})
      CHECK((kLens.distorted(kLens.undistorted({x, y}).value()) - Eigen::Vector2d(x, y)).norm() < 1e-9);
}

TEST_CASE("barrel distortion shows a point nearer to the middle") {
  const Distortion barrel{{-0.1}};
  // By hand: r2 = 0.25, so the factor is 1 - 0.1 * 0.25 = 0.975.
  CHECK((barrel.distorted({0.3, 0.4}) - Eigen::Vector2d(0.2925, 0.39)).norm() < 1e-12);
  // Tangential, p1 = 0.01 and p2 = 0.02: x + 2 p1 x y + p2 (r2 + 2 x^2), y + p1 (r2 + 2 y^2) + 2 p2 x y.
  const Distortion tangential{{0.0, 0.0, 0.01, 0.02}};
  CHECK((tangential.distorted({0.3, 0.4}) - Eigen::Vector2d(0.3110, 0.4105)).norm() < 1e-12);
}

TEST_CASE("a rectified frame is that of a pinhole camera, to half a pixel") {
  const DepthFrame straight = rectified(plane_seen_through(kLens), kLens), pinhole = plane_seen_through({});
  std::size_t seen = 0;
  for (std::size_t i = 0; i < pinhole.depth.size(); ++i) {
    if (!DepthFrame::valid(straight.depth[i])) continue;
    ++seen;
    CHECK(straight.depth[i] == Approx(pinhole.depth[i]).margin(0.003));  // 0.2 / 140 m a pixel
  }
  CHECK(seen > pinhole.depth.size() * 9 / 10);
  const auto k = straight.intrinsics.index(20, 15);
  const auto source = kCamera.project(kLens.distorted(kCamera.ray(20, 15).head<2>()).homogeneous());
  CHECK(std::abs(straight.color[k][0] - source.x()) <= 0.5);
  CHECK(std::abs(straight.color[k][1] - source.y()) <= 0.5);
  CHECK(straight.instances[k] == 1 + static_cast<int>(source.x() + 0.5) / 40);
}

TEST_CASE("without distortion a frame stays as it is") {
  const DepthFrame frame = plane_seen_through({}), out = rectified(frame, {});
  CHECK(out.depth == frame.depth);
  CHECK(out.color == frame.color);
}

TEST_CASE("boxes are rectified with their image") {
  DepthFrame frame = plane_seen_through(kLens);
  Detection d;
  d.instance = 1;
  d.box = PixelBox{10.0, 20.0, 30.0, 24.0};
  frame.detections.push_back(d);
  const PixelBox box = *rectified(frame, kLens).detections[0].box;
  // The middles of its sides, through the lens again, are on the sides of the old one.
  const auto seen = [](double u, double v) {
    return kCamera.project(kLens.distorted(kCamera.ray(u - 0.5, v - 0.5).head<2>()).homogeneous());
  };
  CHECK(seen(box.u, box.v + 0.5 * box.height).x() + 0.5 == Approx(10.0).margin(0.1));
  CHECK(seen(box.u + box.width, box.v + 0.5 * box.height).x() + 0.5 == Approx(40.0).margin(0.1));
  CHECK(seen(box.u + 0.5 * box.width, box.v).y() + 0.5 == Approx(20.0).margin(0.1));
}

TEST_CASE("a box that reaches beyond what the lens shows ends at the border") {
  const Distortion barrel{{-0.3}};
  DepthFrame frame;
  frame.intrinsics = {160, 120, 100.0, 100.0, 79.5, 59.5};  // the lens shows no point this far out at the left border
  frame.depth.assign(frame.intrinsics.size(), 1.0f);
  Detection d;
  d.instance = 1;
  d.box = PixelBox{0.0, 10.0, 60.0, 30.0};
  frame.detections.push_back(d);
  REQUIRE_FALSE(barrel.undistorted(frame.intrinsics.ray(-0.5, 24.5).head<2>()));
  const PixelBox box = *rectified(frame, barrel).detections[0].box;
  CHECK(box.u == 0.0);
  CHECK(box.width > 50.0);
}

TEST_CASE("of a box near the border what the lens shows of it is left") {
  DepthFrame frame;
  frame.intrinsics = {640, 480, 400.0, 400.0, 319.5, 239.5};
  frame.depth.assign(frame.intrinsics.size(), 0.5f);
  Detection d;
  d.instance = 1;
  d.box = PixelBox{0.0, 200.0, 60.0, 60.0};
  frame.detections.push_back(d);
  const auto box = [&](double k1) { return *rectified(frame, Distortion{{k1}}).detections.at(0).box; };
  // Its right side, through the lens again, is where it was; the height grows with the distance from the middle.
  double height = 60.0;
  for (const double k1 : {-0.1, -0.2, -0.25, -0.28}) {
    const PixelBox b = box(k1);
    INFO("k1 = " << k1 << ": " << b.u << " " << b.v << " " << b.width << " " << b.height);
    const double right = (b.u + b.width - 0.5 - 319.5) / 400.0;
    CHECK(right * (1.0 + k1 * right * right) * 400.0 + 319.5 == Approx(59.5).margin(0.5));
    CHECK(b.v + 0.5 * b.height == Approx(230.0).margin(5.0));
    CHECK(b.height > height);
    height = b.height;
  }
  CHECK(height < 110.0);
}

TEST_CASE("a box that leaves the image with its rectification is dropped") {
  DepthFrame frame;
  frame.intrinsics = {640, 480, 400.0, 400.0, 319.5, 239.5};
  frame.depth.assign(frame.intrinsics.size(), 0.5f);
  frame.instances.assign(frame.intrinsics.size(), 0);
  for (int instance = 1; instance <= 4; ++instance) {
    Detection d;
    d.instance = instance;
    frame.detections.push_back(d);
  }
  frame.detections[0].box = PixelBox{0.0, 200.0, 60.0, 60.0};  // ends 4 pixels beyond the border
  frame.detections[1].box = PixelBox{0.0, 0.0, 9.0, 9.0};      // the lens shows nothing of it
  frame.detections[2].box = PixelBox{0.0, 200.0, 60.0, 60.0};  // this one has a mask
  frame.instances[frame.intrinsics.index(320, 240)] = 3;
  const auto left = rectified(frame, Distortion{{-0.3}}).detections;  // the last one never had a box
  REQUIRE(left.size() == 2);
  CHECK(left[0].instance == 3);
  CHECK_FALSE(left[0].box);
  CHECK(left[1].instance == 4);
}

TEST_CASE("a distortion that cannot be is refused") {
  CHECK_THROWS_AS(distortion_from(std::vector<double>{0.1, 0.2, 0.3}), InputError);
  CHECK_THROWS_AS(distortion_from(std::vector<double>{0.1, 0.2, 0.3, NAN}), InputError);
  CHECK(!distortion_from(std::array<double, 0>{}).any());
  CHECK_THROWS_WITH(rectified(plane_seen_through({}), Distortion{{-2.0}}), Catch::Contains("folds the image"));
}

TEST_CASE("a distortion that no lens has is refused") {
  const auto refused = [](const Distortion& lens) {
    CHECK_THROWS_WITH(check(lens, kCamera), Catch::Contains("are these the coefficients of this camera"));
  };
  refused({{100.0}});
  refused({{10.0}});
  refused({{0.0, 0.0, 0.5}});  // tangential: the radial part grows
  refused({{0.0, 0.0, 0.0, 0.5}});
  // Those of depth and color cameras, the last one seen at 120 degrees, and none.
  CHECK_NOTHROW(check({{0.12, -0.24, 0.0, 0.001, 0.1}}, kCamera));
  CHECK_NOTHROW(check({{0.46, -2.4, 0.0004, 0.0001, 1.4, 0.34, -2.2, 1.3}}, kCamera));
  CHECK_NOTHROW(check({{-0.28, 0.07, 0.0003, 0.0, -0.008}}, Intrinsics{1280, 720, 700.0, 700.0, 640.0, 360.0}));
  CHECK_NOTHROW(check({}, kCamera));
}
