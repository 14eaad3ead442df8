// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/sensor/detection_check.hpp>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// A frame of 64 x 48 pixels without masks.
sensor::DepthFrame blank_frame() {
  sensor::DepthFrame frame;
  frame.intrinsics = {64, 48, 50.0, 50.0, 31.5, 23.5};
  frame.depth.assign(frame.intrinsics.size(), 1.0f);
  frame.instances.assign(frame.intrinsics.size(), 0);
  return frame;
}

/// Set an instance in a rectangle.
void fill(sensor::DepthFrame& frame, int u0, int v0, int width, int height, std::uint16_t instance) {
  for (int v = v0; v < v0 + height; ++v)
    for (int u = u0; u < u0 + width; ++u) frame.instances[frame.intrinsics.index(u, v)] = instance;
}

}  // namespace

TEST_CASE("usual masks pass") {
  sensor::DepthFrame frame = blank_frame();
  CHECK_NOTHROW(sensor::check_masks(frame));
  CHECK_FALSE(sensor::doubt_of_masks(frame));
  frame.instances.clear();
  CHECK_FALSE(sensor::doubt_of_masks(frame));
  frame = blank_frame();
  CHECK_NOTHROW(sensor::check_masks({}));
  for (int i = 0; i < 48; ++i) fill(frame, i % 8 * 8, i / 8 * 8, 8, 8, static_cast<std::uint16_t>(i + 1));
  CHECK_NOTHROW(sensor::check_masks(frame));  // they touch
  CHECK_FALSE(sensor::doubt_of_masks(frame));
  frame = blank_frame();
  fill(frame, 10, 10, 12, 12, 7);
  fill(frame, 14, 10, 3, 12, 0);  // a stem in front of a fruit
  fill(frame, 60, 40, 1, 1, 7);   // a stray pixel
  CHECK_FALSE(sensor::doubt_of_masks(frame));
}

TEST_CASE("a depth image is no masks") {
  sensor::DepthFrame frame = blank_frame();
  for (std::size_t i = 0; i < frame.instances.size(); ++i)
    frame.instances[i] = static_cast<std::uint16_t>(i % 64 / 2 + 600);
  CHECK_THROWS_WITH(sensor::check_masks(frame),
                    Catch::Contains("holds 32 instances") && Catch::Contains("depth image?"));
  for (std::size_t i = 0; i < frame.instances.size(); ++i) frame.instances[i] = static_cast<std::uint16_t>(i / 3 + 1);
  CHECK_THROWS_AS(sensor::check_masks(frame), InputError);
}

TEST_CASE("one number for all fruit, or for the background, is doubted") {
  sensor::DepthFrame frame = blank_frame();
  fill(frame, 2, 2, 8, 8, 255);
  CHECK_FALSE(sensor::doubt_of_masks(frame));
  fill(frame, 40, 5, 8, 8, 255);
  fill(frame, 20, 36, 8, 8, 255);
  CHECK_THAT(*sensor::doubt_of_masks(frame), Catch::Contains("instance 255 of the masks lies in 3 places far apart"));
  fill(frame, 50, 30, 8, 8, 1);  // another class
  CHECK(sensor::doubt_of_masks(frame));
  for (std::uint16_t i = 0; i < 3; ++i) fill(frame, 20, 6 * i, 5, 5, static_cast<std::uint16_t>(i + 2));
  CHECK_FALSE(sensor::doubt_of_masks(frame));  // one wrong mask of several
  frame = blank_frame();
  fill(frame, 0, 0, 64, 40, 1);
  CHECK_THAT(*sensor::doubt_of_masks(frame), Catch::Contains("covers 83 % of the image"));
}

TEST_CASE("a listed detection without pixels is doubted, one with a box is not") {
  sensor::DepthFrame frame = blank_frame();
  const auto list = [&](int instance, bool box = false) {
    sensor::Detection d;
    d.instance = instance;
    if (box) d.box = sensor::PixelBox{1.0, 1.0, 5.0, 5.0};
    frame.detections.push_back(d);
  };
  list(3), list(5);
  CHECK(sensor::doubt_of_masks(frame).value() ==
        "the masks are empty: all pixels are 0, although 2 detections are listed");
  fill(frame, 2, 2, 8, 8, 5);
  CHECK(sensor::doubt_of_masks(frame).value() ==
        "1 of 2 listed detections have no pixel in the masks (3), so they are not used");
  fill(frame, 22, 2, 8, 8, 3);
  list(9, true);
  CHECK_FALSE(sensor::doubt_of_masks(frame));
}
