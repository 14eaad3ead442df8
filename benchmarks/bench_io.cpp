// SPDX-License-Identifier: BSD-3-Clause
// Files of clouds and meshes, from and to the temporary folder (in the page cache: parsing is measured, not the disk).
#include <agrisee/core/random.hpp>
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/ply.hpp>

#include <benchmark/benchmark.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace {

using namespace agrisee;

std::filesystem::path temporary(const char* name) {
  return std::filesystem::temp_directory_path() / ("agrisee_bench_" + std::to_string(::getpid()) + "_" + name);
}

Cloud random_cloud(std::size_t n) {
  Rng rng(1);
  Cloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    cloud.points.push_back((rng.direction() * 0.3).cast<float>());
    cloud.normals.push_back(rng.direction().cast<float>());
  }
  return cloud;
}

void count(benchmark::State& state, const std::filesystem::path& path) {
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(std::filesystem::file_size(path)));
  std::filesystem::remove(path);
}

void ply_write(benchmark::State& state) {
  const auto path = temporary("write.ply");
  const Cloud cloud = random_cloud(static_cast<std::size_t>(state.range(0)));
  const Labels labels(cloud.size(), 1);
  for (auto _ : state) io::write_ply(path, cloud, labels);
  count(state, path);
}

void ply_read_binary(benchmark::State& state) {
  const auto path = temporary("read.ply");
  const Cloud cloud = random_cloud(static_cast<std::size_t>(state.range(0)));
  io::write_ply(path, cloud, Labels(cloud.size(), 1));
  for (auto _ : state) benchmark::DoNotOptimize(io::read_ply(path));
  count(state, path);
}

void ply_read_ascii(benchmark::State& state) {
  const auto path = temporary("ascii.ply");
  const Cloud cloud = random_cloud(static_cast<std::size_t>(state.range(0)));
  {
    std::ofstream out(path);
    out << "ply\nformat ascii 1.0\nelement vertex " << cloud.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (const auto& p : cloud.points) out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  }
  for (auto _ : state) benchmark::DoNotOptimize(io::read_ply(path));
  count(state, path);
}

void stl_read(benchmark::State& state) {
  const auto path = temporary("read.stl");
  const auto cells = static_cast<std::uint32_t>(std::sqrt(0.5 * static_cast<double>(state.range(0))));
  Mesh mesh;
  for (std::uint32_t y = 0; y <= cells; ++y)
    for (std::uint32_t x = 0; x <= cells; ++x)
      mesh.vertices.push_back({0.001f * static_cast<float>(x), 0.001f * static_cast<float>(y), 0.0f});
  for (std::uint32_t y = 0; y < cells; ++y)
    for (std::uint32_t x = 0; x < cells; ++x) {
      const std::uint32_t i = y * (cells + 1) + x;
      mesh.triangles.push_back({i, i + 1, i + cells + 1});
      mesh.triangles.push_back({i + 1, i + cells + 2, i + cells + 1});
    }
  io::write_stl(path, mesh);
  for (auto _ : state) benchmark::DoNotOptimize(io::read_stl(path));
  count(state, path);
}

BENCHMARK(ply_write)->Arg(15000)->Arg(150000)->Arg(1500000)->Unit(benchmark::kMillisecond);
BENCHMARK(ply_read_binary)->Arg(15000)->Arg(150000)->Arg(1500000)->Unit(benchmark::kMillisecond);
BENCHMARK(ply_read_ascii)->Arg(15000)->Arg(150000)->Arg(1500000)->Unit(benchmark::kMillisecond);
BENCHMARK(stl_read)->Arg(100000)->Unit(benchmark::kMillisecond);

}  // namespace
