// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/color_prior.hpp>

#include <set>

#include "catch.hpp"

using namespace agrisee;

namespace {

/// An image of leaves with red discs of 20 pixels, all 1 m away: two that touch, and one apart.
sensor::DepthFrame discs() {
  sensor::DepthFrame f;
  f.intrinsics = {200, 120, 600.0, 600.0, 99.5, 59.5};
  f.depth.assign(f.intrinsics.size(), 1.0f);
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 200; ++u) {
      const bool red = std::hypot(u - 40, v - 60) < 20 || std::hypot(u - 76, v - 60) < 20 ||
                       std::hypot(u - 150, v - 60) < 20 || (u == 20 && v == 10);
      f.color.push_back(red ? Rgb{190, 40, 35} : Rgb{60, 120, 50});
    }
  return f;
}

}  // namespace

TEST_CASE("patches of the color of fruit become masks, cut where two touch") {
  const sensor::DepthFrame frame = fuse::detected_by_color(discs());
  REQUIRE(frame.detected);
  REQUIRE(frame.detections.size() == 3);
  const auto at = [&](int u, int v) { return int(frame.instances[frame.intrinsics.index(u, v)]); };
  CHECK(std::set<int>{at(40, 60), at(76, 60), at(150, 60)} == std::set<int>{1, 2, 3});
  CHECK(at(20, 10) == 0);
  CHECK(at(100, 100) == 0);
  for (const sensor::Detection& d : frame.detections) CHECK(d.fruit);
}

TEST_CASE("a step in depth cuts a patch, a detector's masks stay") {
  sensor::DepthFrame frame = discs();
  for (int v = 0; v < 120; ++v)
    for (int u = 150; u < 200; ++u) frame.depth[frame.intrinsics.index(u, v)] = 1.1f;
  const sensor::DepthFrame cut = fuse::detected_by_color(frame);
  CHECK(cut.detections.size() == 4);
  frame.detected = true;
  CHECK(fuse::detected_by_color(frame).detections.empty());
  frame.detected = false;
  frame.color.clear();
  CHECK_FALSE(fuse::detected_by_color(frame).detected);
}
