// SPDX-License-Identifier: BSD-3-Clause
// The tree over triangles, the simulated sensor, and surfaces of frames, by several threads: the same bytes as by one.
#include <agrisee/sensor/reconstruct_surface.hpp>
#include <agrisee/study/capture.hpp>

#include "catch.hpp"
#include "support/shapes.hpp"

using namespace agrisee;

TEST_CASE("threads: build, look, reconstruct") {
  constexpr int kThreads = 4;
  const study::Scene scene = shapes::scene_of(shapes::sphere({0.0, 0.0, 0.5}, 0.1, 300));  // some 90,000 triangles
  sensor::DepthCamera l515 = sensor::l515();
  l515.intrinsics = sensor::intrinsics_from_fov(320, 240, deg(70), deg(55));
  const auto seen = [&](int threads) {
    const study::TracedScene traced(scene, threads);
    return study::capture(traced, l515, Pose::Identity(), study::parse_noise("rough"), 1, 0, threads);
  };
  const study::Capture one = seen(1), more = seen(kThreads);
  CHECK(one.frame.depth == more.frame.depth);
  const Aabb volume{Eigen::Vector3d(-1.0, -1.0, 0.1), Eigen::Vector3d(1.0, 1.0, 1.0)};
  const auto surface = [&](int threads) {
    return sensor::reconstruct_surface(one.frame, one.world_T_optical, volume, {}, threads);
  };
  const sensor::SurfaceImage a = surface(1), b = surface(kThreads);
  CHECK(a.points.size() > 500);
  CHECK(a.points == b.points);
  CHECK(a.normals == b.normals);
  CHECK(a.sigma == b.sigma);
}
