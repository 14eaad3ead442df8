// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/sensor/depth_camera.hpp>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("a camera without intrinsics, or with impossible ones, is refused") {
  CHECK_THROWS_WITH(sensor::DepthCamera().check(), "sensor.intrinsics.width must be 1 or more, got 0");
  const auto refused = [](auto&& change) {
    sensor::DepthCamera camera = sensor::l515();
    CHECK_NOTHROW(camera.check());
    change(camera);
    CHECK_THROWS_AS(camera.check(), ParameterError);
  };
  refused([](sensor::DepthCamera& c) { c.intrinsics.height = 0; });
  refused([](sensor::DepthCamera& c) { c.intrinsics.fx = 0.0; });
  refused([](sensor::DepthCamera& c) { c.intrinsics.fy = -1.0; });
  refused([](sensor::DepthCamera& c) { c.intrinsics.cx = std::nan(""); });
  refused([](sensor::DepthCamera& c) { c.intrinsics.cy = std::nan(""); });
  refused([](sensor::DepthCamera& c) { c.housing_radius = 0.0; });
  refused([](sensor::DepthCamera& c) { c.housing_depth = -0.1; });
  refused([](sensor::DepthCamera& c) { c.range_max = c.range_min; });
}

TEST_CASE("the models are usable cameras") {
  for (const sensor::CameraModel& model : sensor::kCameraModels) {
    INFO(model.name);
    const sensor::DepthCamera camera = model.camera();
    CHECK_NOTHROW(camera.check());
    const double half = std::atan(0.5 * model.width / camera.intrinsics.fx);
    CHECK(2.0 * half / deg(1) == Approx(model.fov_x_deg));
  }
  CHECK(sensor::l515().intrinsics.fx == sensor::intrinsics_from_fov(1024, 768, deg(70), deg(55)).fx);
}

TEST_CASE("a principal point far from the middle is doubted") {
  sensor::Intrinsics k{1024, 768, 731.0, 737.0, 511.0, 383.0};
  CHECK_FALSE(sensor::doubt_of(k));
  k.cx = 700.0;
  CHECK_FALSE(sensor::doubt_of(k));
  std::swap(k.fx, k.cx), std::swap(k.fy, k.cy);
  REQUIRE(sensor::doubt_of(k));
  CHECK(sensor::doubt_of(k)->find("cropped") != std::string::npos);
  CHECK(sensor::doubt_of(k)->find("(731, 737), is far from the middle of the image, 1024 x 768") != std::string::npos);
  k = {480, 640, 600.0, 600.0, 319.5, 239.5};
  REQUIRE(sensor::doubt_of(k));
  CHECK(sensor::doubt_of(k)->find("but in that of one of 640 x 480: is the image transposed?") != std::string::npos);
  k.cx = 239.5, k.cy = 319.5;
  CHECK_FALSE(sensor::doubt_of(k));
}
