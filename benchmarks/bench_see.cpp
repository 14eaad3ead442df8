// SPDX-License-Identifier: BSD-3-Clause
// SEE++: merging, classification from scratch and after one view of ten, and a planning step.
#include <agrisee/see/planner.hpp>

#include <benchmark/benchmark.h>

namespace {

using namespace agrisee;

/// A merged cloud of `n` points: spheres of fruit size (about 1830 points each) at the density of a scan.
const Cloud& merged(std::size_t n) {
  static std::vector<std::pair<std::size_t, Cloud>> made;
  for (const auto& [size, cloud] : made)
    if (size == n) return cloud;
  Rng rng(1);
  see::DensityMap<float> map((see::Parameters()));
  for (int view = 0; map.size() < n; ++view) {
    const double side = 0.2 * std::cbrt(double(n) / 15000.0);
    const Eigen::Vector3d c = side * Eigen::Vector3d(rng.uniform(), rng.uniform(), rng.uniform());
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 40000; ++i) points.push_back((c + 0.035 * rng.direction()).cast<float>());
    map.insert(points, view);
  }
  Cloud cloud = map.cloud();
  cloud.points.resize(n);
  cloud.views.resize(n);
  made.emplace_back(n, std::move(cloud));
  return made.back().second;
}

void classify_from_scratch(benchmark::State& state) {
  const Cloud& cloud = merged(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(see::classify(cloud, see::Parameters()));
}

/// Inserts the last tenth of the points as a new view.
void insert_one_view(benchmark::State& state) {
  const Cloud& cloud = merged(static_cast<std::size_t>(state.range(0)));
  const auto split = static_cast<std::ptrdiff_t>(cloud.size() / 10 * 9);
  const std::vector<Eigen::Vector3f> old(cloud.points.begin(), cloud.points.begin() + split);
  const std::vector<Eigen::Vector3f> added(cloud.points.begin() + split, cloud.points.end());
  see::DensityMap<float> before((see::Parameters()));
  before.insert(old, 0);
  for (auto _ : state) {
    state.PauseTiming();
    see::DensityMap<float> map = before;
    state.ResumeTiming();
    benchmark::DoNotOptimize(map.insert(added, 1));
  }
}

/// Merges 200,000 raw points, about one view, all of which lie near points that are known already.
void merge_seen_points(benchmark::State& state) {
  const Cloud& cloud = merged(static_cast<std::size_t>(state.range(0)));
  see::DensityMap<float> map((see::Parameters()));
  map.insert(cloud, 0);
  std::vector<Eigen::Vector3f> raw;
  for (std::size_t i = 0; i < 200000; ++i)
    raw.push_back(cloud.points[i * cloud.size() / 200000] + Eigen::Vector3f::Constant(1e-4f));
  for (auto _ : state) benchmark::DoNotOptimize(map.insert(raw, 1));
}

/// The first planning step: frames and proposals for all frontiers of a first view; occlusion, visibility graph and
/// order for the nearest 50.
void first_step(benchmark::State& state) {
  const Cloud& cloud = merged(static_cast<std::size_t>(state.range(0)));
  std::vector<Eigen::Vector3f> half;
  const float middle = 0.1f * std::cbrt(float(cloud.size()) / 15000.0f);
  for (const auto& p : cloud.points)
    if (p.y() < middle) half.push_back(p);
  const Eigen::Vector3d sensor(0.1, -0.4, 0.1);
  see::Explorer before((see::Parameters()));
  before.observe(half, sensor);
  state.counters["frontiers"] = double(before.map().of_class(see::PointClass::frontier).size());
  for (auto _ : state) {
    state.PauseTiming();
    see::Explorer explorer = before;
    state.ResumeTiming();
    benchmark::DoNotOptimize(explorer.next_view(sensor));
  }
}

/// Another choice in the same step, after the first one was refused: frames and proposals are kept.
void next_step(benchmark::State& state) {
  const Cloud& cloud = merged(static_cast<std::size_t>(state.range(0)));
  std::vector<Eigen::Vector3f> half;
  const float middle = 0.1f * std::cbrt(float(cloud.size()) / 15000.0f);
  for (const auto& p : cloud.points)
    if (p.y() < middle) half.push_back(p);
  const Eigen::Vector3d sensor(0.1, -0.4, 0.1);
  see::Explorer before((see::Parameters()));
  before.observe(half, sensor);
  if (const auto first = before.next_view(sensor)) before.refuse(*first);
  for (auto _ : state) {
    state.PauseTiming();
    see::Explorer explorer = before;
    state.ResumeTiming();
    benchmark::DoNotOptimize(explorer.next_view(sensor));
  }
}

BENCHMARK(classify_from_scratch)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(insert_one_view)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(merge_seen_points)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(first_step)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(next_step)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);

}  // namespace
