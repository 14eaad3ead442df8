// SPDX-License-Identifier: BSD-3-Clause
// A traced image equals one closest() a pixel, bit for bit, whatever the scene and the number of threads.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/raycast.hpp>

#include "catch.hpp"
#include "support/shapes.hpp"

using namespace agrisee;
using namespace agrisee::study;
using sensor::Intrinsics;
using sensor::intrinsics_from_fov;

namespace {

/// Number of pixels that return something; requires that all equal closest().
std::size_t compare(const TracedScene& scene, const Intrinsics& k, const Pose& pose, double range_min,
                    double range_max) {
  const RayImage image = raycast(scene, k, pose, range_min, range_max);
  REQUIRE(image.range.size() == k.size());
  REQUIRE(image.triangle.size() == k.size());
  const Eigen::Vector3f eye = pose.translation().cast<float>();
  std::size_t hits = 0, wrong = 0, i = 0;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u, ++i) {
      auto hit = scene.bvh().closest(eye, ray_direction(k, pose, u, v), 0.0f, float(range_max));
      if (hit && hit->t < float(range_min)) hit.reset();
      hits += hit.has_value();
      wrong += image.triangle[i] != (hit ? hit->triangle : kNoHit) || image.range[i] != (hit ? hit->t : 0.0f);
    }
  REQUIRE(wrong == 0);
  return hits;
}

}  // namespace

TEST_CASE("a traced image is what single rays find") {
  const Intrinsics k = intrinsics_from_fov(133, 101, deg(70), deg(55));  // no multiple of a tile
  Rng rng(1);
  for (const double size : {0.002, 0.02, 0.3})
    for (int i = 0; i < 4; ++i) {
      const TracedScene scene(shapes::scene_of(shapes::soup(3000, size, std::uint64_t(i))));
      const Eigen::Vector3d eye = 0.8 * rng.direction();
      REQUIRE(compare(scene, k, look_along(eye, -eye, rng.uniform(0.0, 6.0)), 0.25, 9.0) > 10);
      // from amid the triangles: many are partly behind the eye
      REQUIRE(compare(scene, k, look_along(shapes::random_vector(rng, 0.2), rng.direction()), 0.0, 9.0) > 10);
    }
}

TEST_CASE("a traced image is what single rays find where many triangles crowd") {
  const TracedScene scene(shapes::scene_of(shapes::soup(20000, 0.3, 9)));
  const Intrinsics k = intrinsics_from_fov(64, 48, deg(70), deg(55));
  REQUIRE(compare(scene, k, look_along({0, -0.9, 0}, Eigen::Vector3d::UnitY()), 0.25, 9.0) > 1000);
}

TEST_CASE("a traced image of one large and of axis-aligned triangles") {
  const Intrinsics k = intrinsics_from_fov(80, 60, deg(70), deg(55));
  const TracedScene wall(shapes::scene_of(shapes::rectangle({-5, 1, -5}, {10, 0, 0}, {0, 0, 10})));
  REQUIRE(compare(wall, k, look_along({0, 0, 0}, Eigen::Vector3d::UnitY()), 0.25, 9.0) == k.size());
  // A floor under the eye: half of each triangle is behind it.
  const TracedScene floor(shapes::scene_of(shapes::rectangle({-5, -5, -0.5}, {10, 0, 0}, {0, 10, 0})));
  REQUIRE(compare(floor, k, look_along({0, 0, 0}, Eigen::Vector3d::UnitY()), 0.25, 9.0) > k.size() / 4);
  REQUIRE(compare(TracedScene(Scene()), k, Pose::Identity(), 0.0, 9.0) == 0);
}

TEST_CASE("ranges are those of a plane and obey the limits") {
  const Intrinsics k = intrinsics_from_fov(81, 61, deg(70), deg(55));
  const TracedScene wall(shapes::scene_of(shapes::rectangle({-5, 1, -5}, {10, 0, 0}, {0, 0, 10})));
  const Pose pose = look_along({0, 0, 0}, Eigen::Vector3d::UnitY());
  const RayImage image = raycast(wall, k, pose, 1.1, 1.2);
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const std::size_t i = std::size_t(v) * 81 + std::size_t(u);
      const double range = k.ray(u, v).norm();
      if (range < 1.0999 || range > 1.2001) REQUIRE(image.triangle[i] == kNoHit);
      if (range > 1.1001 && range < 1.1999) REQUIRE(double(image.range[i]) == Approx(range).epsilon(1e-6));
    }
}

TEST_CASE("a surface that is too near hides what is behind it") {
  Mesh mesh = shapes::rectangle({-5, 1, -5}, {10, 0, 0}, {0, 0, 10});
  append(mesh, shapes::rectangle({0.0, 0.1, -1}, {1, 0, 0}, {0, 0, 2}));  // covers the right half
  const Intrinsics k = intrinsics_from_fov(40, 30, deg(70), deg(55));
  const RayImage image = raycast(TracedScene(shapes::scene_of(mesh)), k, look_along({0, 0, 0}, {0, 1, 0}), 0.25, 9.0);
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) REQUIRE((image.triangle[std::size_t(v * 40 + u)] == kNoHit) == (u >= 20));
}

TEST_CASE("a traced image does not depend on the number of threads") {
  const TracedScene scene(shapes::scene_of(shapes::soup(5000, 0.05, 4)));
  const Intrinsics k = intrinsics_from_fov(200, 150, deg(70), deg(55));
  const Pose pose = look_along({0, -0.8, 0}, {0, 1, 0});
  const RayImage one = raycast(scene, k, pose, 0.25, 9.0, 1);
  for (const int threads : {2, 3}) {
    const RayImage other = raycast(scene, k, pose, 0.25, 9.0, threads);
    REQUIRE(other.range == one.range);
    REQUIRE(other.triangle == one.triangle);
  }
}

TEST_CASE("cameras and limits that cannot be used are refused") {
  const TracedScene scene{Scene()};
  const Intrinsics k = intrinsics_from_fov(8, 8, 1.0, 1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Pose broken = Pose::Identity();
  broken.translation().x() = nan;
  REQUIRE_THROWS_AS(raycast(scene, k, broken, 0.0, 1.0), InputError);
  broken = Pose::Identity();
  broken.linear() *= 2.0;
  REQUIRE_THROWS_AS(raycast(scene, k, broken, 0.0, 1.0), InputError);
  REQUIRE_THROWS_AS(raycast(scene, Intrinsics(), Pose::Identity(), 0.0, 1.0), InputError);
  Intrinsics bad = k;
  bad.fx = 0.0;
  REQUIRE_THROWS_AS(raycast(scene, bad, Pose::Identity(), 0.0, 1.0), InputError);
  bad = k;
  bad.cy = nan;
  REQUIRE_THROWS_AS(raycast(scene, bad, Pose::Identity(), 0.0, 1.0), InputError);
  REQUIRE_THROWS_AS(raycast(scene, k, Pose::Identity(), -1.0, 1.0), ParameterError);
  REQUIRE_THROWS_AS(raycast(scene, k, Pose::Identity(), 1.0, 0.5), ParameterError);
  REQUIRE_THROWS_AS(raycast(scene, k, Pose::Identity(), 0.0, nan), ParameterError);
}
