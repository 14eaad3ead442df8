// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/views.hpp>

#include <limits>

#include "catch.hpp"
#include "fuse/by_hand.hpp"

using namespace agrisee;

namespace {

/// A frame of the small camera in which all pixels have one depth (m).
sensor::DepthFrame flat(float depth) {
  sensor::DepthFrame frame;
  frame.intrinsics = test::small_camera(8, 6);
  frame.depth.assign(48, depth);
  return frame;
}

}  // namespace

TEST_CASE("the pixels that returned a point inside a volume are counted") {
  // At z = 2 m the pixels are 1/2 m apart: x from -1.5 to 2 and y from -1 to 1.5 about the axis (1, 3) of world x, z.
  const Pose pose = test::small_pose();
  const auto inside = [&](const Aabb& volume) { return fuse::count_inside(flat(2.0f), pose, volume); };
  CHECK(inside({{-9, -9, -9}, {9, 9, 9}}) == 48);
  CHECK(inside({{-9, 4, -9}, {9, 4, 9}}) == 48);  // the border is inside
  CHECK(inside({{-9, 4.01, -9}, {9, 9, 9}}) == 0);
  CHECK(inside({{-9, -9, -9}, {9, 3.99, 9}}) == 0);
  CHECK(inside({{-0.5, -9, -9}, {-0.5, 9, 9}}) == 6);   // the first column
  CHECK(inside({{3.0, -9, -9}, {9, 9, 9}}) == 6);       // the last
  CHECK(inside({{-9, -9, 4.0}, {9, 9, 9}}) == 8);       // the upper row
  CHECK(inside({{-9, -9, -9}, {9, 9, 1.5}}) == 8);      // the lowest
  CHECK(inside({{1.0, -9, 3.0}, {1.0, 9, 3.0}}) == 1);  // the pixel on the axis
  CHECK(inside(Aabb{}) == 0);
}

TEST_CASE("pixels without return are not counted") {
  const float none[] = {0.0f, -2.0f, std::nanf(""), std::numeric_limits<float>::infinity()};
  sensor::DepthFrame frame = flat(2.0f);
  for (std::size_t i = 0; i < 4; ++i) frame.depth[7 * i] = none[i];
  const Aabb everything{{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};
  CHECK(fuse::count_inside(frame, test::small_pose(), everything) == 44);
  CHECK(fuse::count_inside(flat(0.0f), test::small_pose(), everything) == 0);
  CHECK(fuse::count_inside(sensor::DepthFrame{}, test::small_pose(), everything) == 0);
}

TEST_CASE("an observation is consistent and a change is none until something else is found") {
  CHECK(fuse::Observation{}.consistent);
  const fuse::Change change;
  CHECK(change.points_in == 0);
  CHECK(change.added.empty());
  CHECK_FALSE(change.kept);
}
