// SPDX-License-Identifier: BSD-3-Clause
// The default path: surface from a frame, fusion, split, whole processing of a cloud of 15 k and 150 k points.
#include <agrisee/cloud/split.hpp>
#include <agrisee/fuse/surfels.hpp>
#include <agrisee/process.hpp>
#include <agrisee/sensor/reconstruct_surface.hpp>
#include <agrisee/study/capture.hpp>
#include <agrisee/study/truss.hpp>

#include <benchmark/benchmark.h>

namespace {

using namespace agrisee;

/// One simulated 1024 x 768 frame of a 7-fruit truss.
struct View {
  study::Truss truss = study::make_truss({});
  Pose pose = look_along({0.1, 0.16, 0.21}, {-0.2, 1.0, 0.0});
  study::Capture capture;

  explicit View(const char* noise) {
    capture =
        study::capture(study::TracedScene(truss.scene), truss.workcell.sensor, pose, study::parse_noise(noise), 1, 0);
  }
};

void surface(benchmark::State& state, const char* noise) {
  const View view(noise);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        sensor::reconstruct_surface(view.capture.frame, view.pose, view.truss.workcell.scan_volume));
}
BENCHMARK_CAPTURE(surface, l515, "l515")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(surface, gaussian_10mm, "gaussian:0.01")->Unit(benchmark::kMillisecond);

void fuse(benchmark::State& state) {
  const View view("l515");
  const auto image = sensor::reconstruct_surface(view.capture.frame, view.pose, view.truss.workcell.scan_volume);
  for (auto _ : state) {
    fuse::SurfelMap map;
    for (int v = 0; v < 4; ++v)
      for (std::size_t i = 0; i < image.points.size(); ++i)
        map.add(image.points[i], image.normals[i], image.sigma[i], v);
    benchmark::DoNotOptimize(map.size());
  }
}
BENCHMARK(fuse)->Unit(benchmark::kMillisecond);

/// Spheres of 35 mm on a grid, seen from everywhere, 2.4 mm apart, with 0.3 mm of noise.
Cloud spheres(std::size_t points) {
  Cloud cloud;
  Rng rng(1);
  for (int s = 0; cloud.size() < points; ++s) {
    const Eigen::Vector3d center(0.075 * (s % 6), 0.075 * (s / 6 % 6), 0.075 * (s / 36));
    constexpr int kPoints = 2670;
    for (int i = 0; i < kPoints && cloud.size() < points; ++i) {
      const Eigen::Vector3d d = rng.direction();
      cloud.points.push_back((center + (0.035 + 0.0003 * rng.normal()) * d).cast<float>());
      cloud.normals.push_back(d.cast<float>());
    }
  }
  return cloud;
}

void split_bodies(benchmark::State& state) {
  const Cloud cloud = spheres(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(split(cloud));
}
BENCHMARK(split_bodies)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);

void process_cloud(benchmark::State& state) {
  Cloud cloud = spheres(static_cast<std::size_t>(state.range(0)));
  cloud.normals.clear();
  for (auto _ : state) benchmark::DoNotOptimize(process(cloud));
}
BENCHMARK(process_cloud)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);

}  // namespace
