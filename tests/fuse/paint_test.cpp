// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/fuse/paint.hpp>

#include "catch.hpp"
#include "fuse/by_hand.hpp"

using namespace agrisee;

namespace {

/// A view of the small camera in which all pixels have one depth (m) and one color.
fuse::DetectedView flat(float depth, const Rgb& color, const Pose& pose = Pose::Identity()) {
  sensor::DepthFrame frame;
  frame.intrinsics = test::small_camera(8, 6);
  frame.depth.assign(48, depth);
  frame.color.assign(48, color);
  return {std::move(frame), pose};
}

/// A cloud of one point, on the axis of a camera at the origin, with a normal towards it or without.
Cloud one_point(float z, bool with_normal) {
  Cloud cloud;
  cloud.points = {{0.0f, 0.0f, z}};
  if (with_normal) cloud.normals = {{0.0f, 0.0f, -1.0f}};
  return cloud;
}

/// A camera 1 m from (0, 0, 1), `angle` (rad) away from the origin.
Pose aside(double angle) {
  const Eigen::Vector3d away(std::sin(angle), 0.0, -std::cos(angle));
  return look_along(Eigen::Vector3d(Eigen::Vector3d::UnitZ() + away), Eigen::Vector3d(-away));
}

const Rgb kBlack{0, 0, 0};

}  // namespace

TEST_CASE("a color is the mean over the views, weighted by how directly they face the surface") {
  const std::vector<fuse::DetectedView> views{flat(1.0f, {200, 0, 40}), flat(1.0f, {80, 90, 40}, aside(deg(60.0)))};
  CHECK(fuse::colors_of(one_point(1.0f, true), views) == std::vector<Rgb>{{160, 30, 40}});  // 1 : 1/2
  CHECK(fuse::colors_of(one_point(1.0f, false), views) == std::vector<Rgb>{{140, 45, 40}});
}

TEST_CASE("a surface seen at a slant, or from behind, counts a tenth") {
  for (const double angle : {deg(88.0), deg(120.0), deg(180.0)}) {
    const fuse::DetectedView slant = flat(1.0f, {250, 120, 2}, aside(angle));
    CHECK(fuse::colors_of(one_point(1.0f, true), {slant}) == std::vector<Rgb>{{250, 120, 2}});
    CHECK(fuse::colors_of(one_point(1.0f, true), {flat(1.0f, {30, 10, 2}), slant}) == std::vector<Rgb>{{50, 20, 2}});
  }
}

TEST_CASE("a point is seen where the depth agrees to within 1 %, near the camera 4 mm") {
  const auto seen = [](float depth, float z) {
    return fuse::colors_of(one_point(z, false), {flat(depth, {9, 8, 7})})[0] != kBlack;
  };
  for (const float sign : {-1.0f, 1.0f}) {
    CHECK(seen(0.2f, 0.2f + sign * 0.0038f));
    CHECK_FALSE(seen(0.2f, 0.2f + sign * 0.0042f));
    CHECK(seen(2.0f, 2.0f + sign * 0.0195f));
    CHECK_FALSE(seen(2.0f, 2.0f + sign * 0.0205f));
  }
  CHECK_FALSE(seen(0.0f, 0.001f));  // no return
}

TEST_CASE("each point takes the color of its own pixel") {
  fuse::DetectedView view = flat(1.0f, kBlack);
  sensor::DepthFrame frame = *view.frame;
  Cloud cloud;
  std::vector<Rgb> expected;
  for (int v = 0; v < 6; ++v)
    for (int u = 0; u < 8; ++u) {
      const Rgb color{static_cast<std::uint8_t>(10 * u + 5), static_cast<std::uint8_t>(20 * v), 3};
      frame.color[frame.intrinsics.index(u, v)] = color;
      cloud.points.emplace_back(0.25f * float(u - 3), 0.25f * float(v - 2), 1.0f);
      expected.push_back(color);
    }
  CHECK(fuse::colors_of(cloud, {{frame, Pose::Identity()}}) == expected);
  for (Eigen::Vector3f& p : cloud.points) p += Eigen::Vector3f(1, 2, 3);
  Pose moved = Pose::Identity();
  moved.translation() = Eigen::Vector3d(1, 2, 3);
  CHECK(fuse::colors_of(cloud, {{frame, moved}}) == expected);
}

TEST_CASE("views without colors are ignored, whatever else they lack") {
  sensor::DepthFrame bare = *flat(1.0f, kBlack).frame;
  bare.color.clear();
  const fuse::DetectedView view = flat(1.0f, {200, 100, 0}), without{bare, Pose::Identity()};
  const fuse::DetectedView nothing{sensor::DepthFrame{}, Pose::Identity()};
  for (const auto& views : {std::vector{without, view}, std::vector{view, without}, std::vector{nothing, view}})
    CHECK(fuse::colors_of(one_point(1.0f, true), views) == std::vector<Rgb>{{200, 100, 0}});
  CHECK(fuse::colors_of(one_point(1.0f, true), {without, nothing}).empty());
  CHECK(fuse::colors_of(one_point(1.0f, true), {}).empty());
  CHECK(fuse::colors_of({}, {view}).empty());
}

TEST_CASE("views without frame, and a cloud whose arrays differ in length, get no colors") {
  const fuse::DetectedView view = flat(1.0f, {200, 100, 0});
  CHECK_THROWS_WITH(fuse::colors_of(one_point(1.0f, true), {view, {}}), Catch::Contains("has no frame"));
  Cloud cloud = one_point(1.0f, true);
  cloud.points.push_back(cloud.points[0]);
  CHECK_THROWS_AS(fuse::colors_of(cloud, {view}), InputError);
}
