// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the programs that compare with other libraries share: the clouds, and runs named stage/library/points/threads
/// whose answers are checked once.
#pragma once

#include <agrisee/neighbors/kdtree.hpp>

#include <benchmark/benchmark.h>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <malloc.h>
#include <map>
#include <set>
#include <string>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "../bench_clouds.hpp"

namespace agrisee::peers {

/// The truss of n points that all libraries get.
inline const Cloud& cloud(std::size_t n) {
  static std::map<std::size_t, Cloud> clouds;
  Cloud& c = clouds[n];
  if (c.points.empty()) c = bench::noisy_truss(n);
  return c;
}

/// Radius (m) within which a point of cloud(n) has about `neighbors` points.
inline float radius_of(std::size_t n, double neighbors) {
  const double area = 7.0 * 4.0 * kPi * 0.035 * 0.035;
  return static_cast<float>(std::sqrt(neighbors * area / (kPi * static_cast<double>(n))));
}

/// Ends the program when two libraries disagree: times of different answers say nothing.
inline void require(bool same, const std::string& what) {
  if (same) return;
  std::fprintf(stderr, "the answers differ: %s\n", what.c_str());
  std::exit(1);
}

/// Peak memory of the process so far (MB), Linux only; `forget_peak` starts anew, with what is free given back.
inline double peak_megabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:" && status >> word) return std::atof(word.c_str()) * 1024e-6;
  return 0.0;
}
inline void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;
}

/// Register a run. `run(threads)` returns the answer, `check(answer)` is called once for it.
template <typename Run, typename Check>
void add(const std::string& stage, const std::string& library, std::size_t n, int threads, Run run, Check check) {
  const std::string name = stage + "/" + library + "/" + std::to_string(n) + "/" + std::to_string(threads);
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& state) {
#ifdef _OPENMP
                                 omp_set_num_threads(threads);
#endif
                                 static std::map<std::string, double> peaks;
                                 if (!peaks.count(name)) {  // also warms up
                                   run(threads);
                                   forget_peak();
                                   const double before = peak_megabytes();
                                   const auto answer = run(threads);
                                   peaks[name] = peak_megabytes() - before;
                                   check(answer);
                                 }
                                 for (auto _ : state) benchmark::DoNotOptimize(run(threads));
                                 state.counters["peak_MB"] = peaks[name];
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

/// f(n, threads) for all sizes and numbers of threads.
template <typename F>
void for_sizes(F&& f) {
  for (const std::size_t n : {15000u, 150000u, 1500000u})
    for (const int threads : {1, 2}) f(n, threads);
}

/// No check: the one that the others are compared with.
struct Unchecked {
  template <typename T>
  void operator()(const T&) const {}
};

inline int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace agrisee::peers
