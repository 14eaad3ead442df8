// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/sensor/camera_info.hpp>

#include <catch2/catch.hpp>
#include <cmath>

using namespace agrisee;

namespace camera_info_test {

namespace {

sensor::CameraInfo usual() {
  sensor::CameraInfo info;
  info.width = 4;
  info.height = 3;
  info.distortion_model = "plumb_bob";
  info.d.assign(5, 0.0);
  info.k = {100.0, 0.0, 1.5, 0.0, 110.0, 1.0, 0.0, 0.0, 1.0};
  info.p = {90.0, 0.0, 1.25, 0.0, 0.0, 95.0, 0.75, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

void require_intrinsics(const sensor::Intrinsics& k, double fx, double fy, double cx, double cy) {
  CHECK((k.width == 4 && k.height == 3));
  CHECK((k.fx == fx && k.fy == fy && k.cx == cx && k.cy == cy));
}

}  // namespace

TEST_CASE("a CameraInfo has K for images as taken and P for rectified ones") {
  sensor::CameraInfo info = usual();
  require_intrinsics(sensor::intrinsics_of(info), 100.0, 110.0, 1.5, 1.0);
  require_intrinsics(sensor::intrinsics_of(info, true), 90.0, 95.0, 1.25, 0.75);
  CHECK_FALSE(sensor::distortion_of(info).any());
  info.binning_x = info.binning_y = 1;
  info.roi_width = 4;
  info.roi_height = 3;
  info.d[0] = 0.1;
  require_intrinsics(sensor::intrinsics_of(info, true), 90.0, 95.0, 1.25, 0.75);
  CHECK(sensor::distortion_of(info).k[0] == 0.1);
}

TEST_CASE("K stands for an empty P where the lens does not distort") {
  sensor::CameraInfo info = usual();
  info.p.fill(0.0);
  require_intrinsics(sensor::intrinsics_of(info, true), 100.0, 110.0, 1.5, 1.0);
  info.d[0] = 0.1;
  CHECK_NOTHROW(sensor::intrinsics_of(info, false));
  CHECK_THROWS_WITH(sensor::intrinsics_of(info, true), Catch::Contains("P is empty"));
}

TEST_CASE("a CameraInfo that describes no pinhole is refused") {
  const auto refuses = [](void (*change)(sensor::CameraInfo&), const char* text, bool rectified = false) {
    sensor::CameraInfo info = usual();
    change(info);
    CHECK_THROWS_AS(sensor::intrinsics_of(info, rectified), InputError);
    CHECK_THROWS_WITH(sensor::intrinsics_of(info, rectified), Catch::Contains(text));
  };
  using C = sensor::CameraInfo;
  refuses([](C& c) { c.width = 0; }, "0 x 3 pixels");
  refuses([](C& c) { c.height = 16385; }, "4 x 16385 pixels");
  refuses([](C& c) { c.binning_x = 2; }, "binning");
  refuses([](C& c) { c.binning_y = 2; }, "binning", true);
  refuses([](C& c) { c.roi_x_offset = 1; }, "region of interest");
  refuses([](C& c) { c.roi_y_offset = 1; }, "region of interest");
  refuses([](C& c) { c.roi_width = 2; }, "region of interest");
  refuses([](C& c) { c.roi_height = 2; }, "region of interest");
  refuses([](C& c) { c.k[0] = 0.0; }, "no focal length: 0 and 110 (k[0] and k[4])");
  refuses([](C& c) { c.k[4] = -1.0; }, "no focal length: 100 and -1 (k[0] and k[4])");
  refuses([](C& c) { c.p[5] = std::nan(""); }, "(p[0] and p[5])", true);
  refuses([](C& c) { c.k[5] = std::nan(""); }, "principal point");
}

TEST_CASE("distortions of other models are refused, unless all coefficients are 0") {
  sensor::CameraInfo info = usual();
  info.distortion_model = "equidistant\n" + std::string(100, 'x');
  CHECK_FALSE(sensor::distortion_of(info).any());
  info.d[4] = 1e-3;
  CHECK_THROWS_WITH(sensor::distortion_of(info), Catch::Contains("'equidistant?" + std::string(28, 'x') + "',"));
  for (const char* model : {"", "plumb_bob", "rational_polynomial"}) {
    info.distortion_model = model;
    CHECK(sensor::distortion_of(info).k[4] == 1e-3);
  }
  info.d.assign(3, 0.1);
  CHECK_THROWS_AS(sensor::distortion_of(info), InputError);
}

}  // namespace camera_info_test
