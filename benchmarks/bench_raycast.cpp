// SPDX-License-Identifier: BSD-3-Clause
// The tree and a full 1024 x 768 frame on a scene of about 100,000 triangles: 30 spheres of 24 to 36 mm, 0.5 m in front
// of the sensor, met by about one ray in seven.
#include <agrisee/core/random.hpp>
#include <agrisee/geometry/bvh.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/raycast.hpp>

#include <benchmark/benchmark.h>

#include "../tests/support/shapes.hpp"

using namespace agrisee;

namespace {

const study::Scene& spheres() {
  static const study::Scene scene = [] {
    study::Scene s;
    Rng rng(1);
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector3d center(rng.uniform(-0.13, 0.13), rng.uniform(0.42, 0.62), rng.uniform(0.06, 0.34));
      s.objects.push_back(
          {i + 1, study::ObjectClass::fruit, shapes::sphere(center, rng.uniform(0.024, 0.036), 59 + i % 2)});
    }
    return s;
  }();
  return scene;
}

Pose eye() { return look_along({0.0, 0.0, 0.2}, Eigen::Vector3d::UnitY()); }

void build(benchmark::State& state) {
  const study::Scene& scene = spheres();
  for (auto _ : state) benchmark::DoNotOptimize(study::TracedScene(scene));
  state.counters["triangles"] = double(study::TracedScene(scene).size());
}
BENCHMARK(build)->Unit(benchmark::kMillisecond);

void frame(benchmark::State& state) {
  const study::TracedScene scene(spheres());
  const sensor::DepthCamera l515 = sensor::l515();
  std::size_t hits = 0;
  for (auto _ : state) {
    const auto image =
        study::raycast(scene, l515.intrinsics, eye(), l515.range_min, l515.range_max, int(state.range(0)));
    hits = image.triangle.size() - std::size_t(std::count(image.triangle.begin(), image.triangle.end(), study::kNoHit));
  }
  state.counters["hit_share"] = double(hits) / double(l515.intrinsics.size());
}
BENCHMARK(frame)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

// The same frame, one closest() a pixel.
void frame_ray_by_ray(benchmark::State& state) {
  const study::TracedScene scene(spheres());
  const sensor::DepthCamera l515 = sensor::l515();
  const Eigen::Vector3f origin = eye().translation().cast<float>();
  for (auto _ : state) {
    std::size_t hits = 0;
    for (int v = 0; v < l515.intrinsics.height; ++v)
      for (int u = 0; u < l515.intrinsics.width; ++u)
        if (scene.bvh().closest(origin, study::ray_direction(l515.intrinsics, eye(), u, v))) ++hits;
    benchmark::DoNotOptimize(hits);
  }
}
BENCHMARK(frame_ray_by_ray)->Unit(benchmark::kMillisecond);

void nearest(benchmark::State& state) {
  const study::TracedScene scene(spheres());
  Rng rng(2);
  std::vector<Eigen::Vector3f> queries;
  for (int i = 0; i < 10000; ++i)
    queries.emplace_back(float(rng.uniform(-0.13, 0.13)), float(rng.uniform(0.42, 0.62)),
                         float(rng.uniform(0.06, 0.34)));
  for (auto _ : state)
    for (const auto& q : queries) benchmark::DoNotOptimize(scene.bvh().nearest(q));
  state.SetItemsProcessed(state.iterations() * 10000);
}
BENCHMARK(nearest)->Unit(benchmark::kMillisecond);

void capture(benchmark::State& state, const char* noise) {
  const study::TracedScene scene(spheres());
  const sensor::DepthCamera l515 = sensor::l515();
  const study::NoiseModel model = study::parse_noise(noise);
  for (auto _ : state) benchmark::DoNotOptimize(study::capture(scene, l515, eye(), model, 1, 0));
}
BENCHMARK_CAPTURE(capture, none, "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(capture, gaussian, "gaussian:0.01")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(capture, l515, "l515")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(capture, rough, "rough")->Unit(benchmark::kMillisecond);

}  // namespace
