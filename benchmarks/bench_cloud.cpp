// SPDX-License-Identifier: BSD-3-Clause
// Every stage of the consolidated cloud, on 15k and 150k points of a noisy truss, one thread.
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/icp.hpp>
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/orient_normals.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/sor.hpp>

#include <benchmark/benchmark.h>

#include "bench_clouds.hpp"

using namespace agrisee;

namespace {

Cloud cloud_of(const benchmark::State& state) { return bench::noisy_truss(static_cast<std::size_t>(state.range(0))); }

void outlier_removal(benchmark::State& state) {
  const Cloud cloud = cloud_of(state);
  std::size_t kept = 0;
  for (auto _ : state) benchmark::DoNotOptimize(kept = remove_statistical_outliers(cloud).size());
  state.counters["kept"] = static_cast<double>(kept);
}

void normals(benchmark::State& state) {
  const Cloud cloud = cloud_of(state);
  for (auto _ : state) benchmark::DoNotOptimize(estimate_normals(cloud));
}

void normals_consistent(benchmark::State& state) {
  const Cloud cloud = cloud_of(state);
  for (auto _ : state) benchmark::DoNotOptimize(orient_normals_consistently(cloud.normals, cloud));
}

void region_growing(benchmark::State& state) {
  const Cloud cloud = cloud_of(state);
  const std::vector<int> views(cloud.size(), 0);  // all from one sensor
  const std::vector<Eigen::Vector3d> sensors(1, {0.0, 0.0, 0.5});
  const auto estimated = orient_normals_to_views(estimate_normals(cloud), cloud, views, sensors);
  int regions = 0;
  for (auto _ : state) {
    const Labels labels = grow_regions(cloud, estimated);
    regions = *std::max_element(labels.begin(), labels.end());
  }
  state.counters["regions"] = regions;
}

void clustering(benchmark::State& state) {
  const Cloud cloud = cloud_of(state);
  DbscanParameters parameters;
  parameters.min_points = state.range(0) > 50000 ? 60 : 20;
  int clusters = 0;
  for (auto _ : state) {
    const Labels labels = dbscan(cloud, parameters);
    clusters = *std::max_element(labels.begin(), labels.end());
  }
  state.counters["clusters"] = clusters;
}

/// A tenth of the points, moved by 2 mm and half a degree, against another sample of the same truss.
void registration(benchmark::State& state) {
  const Cloud target = cloud_of(state);
  const Eigen::Vector3d middle(0.0, 0.545, 0.5);
  Pose moved = Pose::Identity();
  moved.translate(middle).rotate(Eigen::AngleAxisd(deg(0.5), Eigen::Vector3d::UnitX()));
  moved.translate(Eigen::Vector3d(0.001, 0.0, 0.001) - middle);
  Cloud source = bench::noisy_truss(target.size() / 10, 2);
  for (auto& p : source.points) p = (moved * p.cast<double>()).cast<float>();
  for (auto& n : source.normals) n = (moved.linear() * n.cast<double>()).cast<float>();
  IcpResult result;
  for (auto _ : state)
    benchmark::DoNotOptimize(result = register_cloud(source, source.normals, target, target.normals));
  state.counters["iterations"] = result.iterations;
  state.counters["error_um"] = 1e6 * (result.target_T_source * moved * middle - middle).norm();
}

/// Neighbors within 40 mm, at most 537, of every point: what the density of a frontier point takes.
void density_counts(benchmark::State& state) {
  const Cloud cloud = cloud_of(state);
  for (auto _ : state) {
    const Grid<float> grid(cloud, 0.02f);
    std::size_t sum = 0;
    for (const auto& p : cloud.points) sum += grid.count(p, 0.04f, 537);
    benchmark::DoNotOptimize(sum);
  }
}

}  // namespace

BENCHMARK(outlier_removal)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(normals)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(normals_consistent)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(region_growing)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(clustering)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(registration)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
BENCHMARK(density_counts)->Arg(15000)->Arg(150000)->Unit(benchmark::kMillisecond);
