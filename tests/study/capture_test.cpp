// SPDX-License-Identifier: BSD-3-Clause
// A captured frame is what geometry says: depths of a sphere and a plane, limits, incidence, determinism.
#include <agrisee/study/capture.hpp>

#include "catch.hpp"
#include "support/shapes.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

sensor::DepthCamera small_sensor() {
  sensor::DepthCamera sensor = sensor::l515();
  sensor.intrinsics = sensor::intrinsics_from_fov(256, 192, deg(70), deg(55));
  return sensor;
}

const Pose kPose = look_along({0.02, 0.05, 0.2}, {0.1, 1.0, -0.05}, 0.3);

Capture look(const TracedScene& scene, const sensor::DepthCamera& sensor, const char* noise, std::uint64_t view = 0,
             int threads = 1) {
  return capture(scene, sensor, kPose, parse_noise(noise), 11, view, threads);
}

}  // namespace

TEST_CASE("the points of a captured sphere lie on it") {
  const Eigen::Vector3d center(0.05, 0.5, 0.18);
  const TracedScene scene(shapes::scene_of(shapes::sphere(center, 0.04, 200)));
  const Capture c = look(scene, small_sensor(), "none");
  REQUIRE(c.world_T_optical.matrix() == kPose.matrix());
  check(c.frame);
  int n = 0;
  double steepest = 0.0;
  for (int v = 0; v < 192; ++v)
    for (int u = 0; u < 256; ++u) {
      if (!sensor::DepthFrame::valid(c.frame.at(u, v))) continue;
      ++n;
      const Eigen::Vector3d p = kPose * c.frame.point(u, v).cast<double>();
      REQUIRE((p - center).norm() == Approx(0.04).margin(2e-5));
      const double cosine = (p - center).normalized().dot((kPose.translation() - p).normalized());
      REQUIRE(cosine > std::cos(deg(81.5)));  // facets differ from the sphere by up to a degree
      steepest = std::max(steepest, std::acos(cosine));
    }
  REQUIRE(n > 500);
  REQUIRE(steepest > deg(70));
}

TEST_CASE("a tilted plane returns nothing beyond the largest incidence") {
  // A wall that runs away from the sensor along y, 0.3 m to its right: incidence grows with distance.
  const TracedScene scene(shapes::scene_of(shapes::rectangle({0.3, 0, -1}, {0, 8, 0}, {0, 0, 2})));
  sensor::DepthCamera sensor = small_sensor();
  const Pose pose = look_along({0, 0, 0}, {0, 1, 0});
  for (const double limit : {40.0, 60.0, 80.0}) {
    sensor.max_incidence = deg(limit);
    const Capture c = capture(scene, sensor, pose, {}, 1, 0);
    int returned = 0, lost = 0;
    for (int v = 0; v < 192; ++v)
      for (int u = 0; u < 256; ++u) {
        const Eigen::Vector3d ray = sensor.intrinsics.ray(u, v);
        if (!(ray.x() > 0.05) || std::abs(ray.y()) * 0.3 / ray.x() > 0.99) continue;
        const double incidence = std::acos(ray.x() / ray.norm()) / deg(1);
        const bool valid = sensor::DepthFrame::valid(c.frame.at(u, v));
        if (incidence < limit - 0.1) REQUIRE(valid);
        if (incidence > limit + 0.1) REQUIRE_FALSE(valid);
        if (valid) REQUIRE(double(c.frame.at(u, v)) == Approx(0.3 / ray.x()).epsilon(1e-5));
        ++(valid ? returned : lost);
      }
    REQUIRE((limit == 40.0 || returned > 100));
    REQUIRE(lost > 100);
  }
}

TEST_CASE("measured ranges stay within the limits along the ray") {
  const TracedScene scene(shapes::scene_of(shapes::rectangle({-5, 0.5, -5}, {10, 0, 0}, {0, 0, 10})));
  sensor::DepthCamera sensor = small_sensor();
  sensor.range_min = 0.51;
  sensor.range_max = 0.56;
  for (const char* noise : {"none", "gaussian:0.01", "rough"}) {
    const Capture c = capture(scene, sensor, look_along({0, 0, 0}, {0, 1, 0}), parse_noise(noise), 1, 0);
    int n = 0;
    for (int v = 0; v < 192; ++v)
      for (int u = 0; u < 256; ++u) {
        if (!sensor::DepthFrame::valid(c.frame.at(u, v))) continue;
        const double range = double(c.frame.at(u, v)) * sensor.intrinsics.ray(u, v).norm();
        REQUIRE(range >= 0.51 - 1e-6);
        REQUIRE(range <= 0.56 + 1e-6);
        ++n;
      }
    REQUIRE(n > 1000);
  }
}

TEST_CASE("a frame does not depend on the number of threads") {
  const TracedScene scene(shapes::scene_of(shapes::sphere({0.05, 0.5, 0.18}, 0.04, 60)));
  for (const char* noise : {"none", "gaussian:0.01", "l515", "azure:sun", "d405", "rough"}) {
    INFO(noise);
    const Capture one = look(scene, small_sensor(), noise, 3, 1);
    for (const int threads : {2, 3}) {
      const Capture other = look(scene, small_sensor(), noise, 3, threads);
      REQUIRE(other.frame.depth == one.frame.depth);
      REQUIRE(other.world_T_optical.matrix() == one.world_T_optical.matrix());
    }
    const Capture next = look(scene, small_sensor(), noise, 4);
    REQUIRE((next.frame.depth == one.frame.depth) == (std::string(noise) == "none"));
    REQUIRE((next.world_T_optical.matrix() == one.world_T_optical.matrix()) == (std::string(noise) != "rough"));
  }
}

TEST_CASE("a sensor that cannot be used is refused") {
  const TracedScene scene{Scene()};
  const auto with = [](auto change) {
    sensor::DepthCamera s = small_sensor();
    change(s);
    return s;
  };
  REQUIRE_THROWS_AS(look(scene, with([](sensor::DepthCamera& s) { s.range_min = -0.1; }), "none"), ParameterError);
  REQUIRE_THROWS_AS(look(scene, with([](sensor::DepthCamera& s) { s.range_max = s.range_min; }), "none"),
                    ParameterError);
  REQUIRE_THROWS_AS(look(scene, with([](sensor::DepthCamera& s) { s.max_incidence = 0.0; }), "none"), ParameterError);
  REQUIRE_THROWS_AS(look(scene, with([](sensor::DepthCamera& s) { s.max_incidence = std::nan(""); }), "none"),
                    ParameterError);
  REQUIRE_THROWS_AS(look(scene, with([](sensor::DepthCamera& s) { s.intrinsics.width = 0; }), "none"), ParameterError);
  const Capture nothing = look(scene, small_sensor(), "rough");
  REQUIRE(std::count(nothing.frame.depth.begin(), nothing.frame.depth.end(), 0.0f) == 256 * 192);
}
