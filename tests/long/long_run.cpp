// SPDX-License-Identifier: BSD-3-Clause
// Scans many trusses in one process, one after the other, and checks whether memory or time grow: long_run N [EVERY].
// After every EVERY trusses (default 50) it prints the resident memory and the processor time per scan. With N of at
// least 100 it fails if the last fifth needs over 5 % more memory, or over 10 % more time per view, than the second.
#include <agrisee/study/simulated_scan.hpp>
#include <agrisee/study/truss.hpp>

#include <ctime>
#include <fstream>
#include <iostream>
#include <string>
#include <unistd.h>

using namespace agrisee;

namespace {

/// Resident memory of this process (MB); 0 if the system does not report it.
double resident() {
  std::ifstream statm("/proc/self/statm");
  double all = 0.0, in_ram = 0.0;
  statm >> all >> in_ram;
  return in_ram * double(sysconf(_SC_PAGESIZE)) / 1e6;
}

double processor_time() { return double(std::clock()) / CLOCKS_PER_SEC; }

struct Sample {
  double seconds = 0.0;  // processor time of a scan, the simulated sensor included
  double views = 0.0, memory = 0.0;
};

/// The mean over one fifth of the samples; `fifth` counts from 0.
template <typename F>
double mean_of_fifth(const std::vector<Sample>& samples, std::size_t fifth, F&& value) {
  const std::size_t begin = fifth * samples.size() / 5, end = (fifth + 1) * samples.size() / 5;
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i) sum += value(samples[i]);
  return sum / double(end - begin);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::stoi(argv[1]) : 100, every = argc > 2 ? std::stoi(argv[2]) : 50;
  std::vector<Sample> samples;
  std::size_t fruit = 0, found = 0;
  double since = 0.0;
  for (std::uint64_t seed = 1; static_cast<int>(samples.size()) < runs; ++seed) {
    study::TrussParameters parameters;
    parameters.total = 4 + static_cast<int>(seed % 5);
    parameters.hidden = static_cast<int>(seed % 2);
    parameters.seed = seed;
    std::optional<study::Truss> truss;
    try {
      truss = study::make_truss(parameters);
    } catch (const ParameterError&) {  // this seed gives no such truss
      continue;
    }
    const study::TracedScene scene(truss->scene);
    study::SimulationOptions options;
    options.noise = study::parse_noise("l515");
    options.seed = seed;
    const double before = processor_time();
    const ScanResult result = study::scan(truss->workcell, scene, {}, std::move(options));
    samples.push_back({processor_time() - before, double(result.views.size()), resident()});
    since += samples.back().seconds;
    fruit += truss->truth.fruits.size();
    found += result.fruits.size();
    if (static_cast<int>(samples.size()) % every == 0 || static_cast<int>(samples.size()) == runs) {
      const int in_block = (static_cast<int>(samples.size()) - 1) % every + 1;
      std::cout << samples.size() << " trusses: " << samples.back().memory << " MB, " << since / in_block
                << " s a scan, " << found << " fruit located of " << fruit << std::endl;
      since = 0.0;
    }
  }
  if (runs < 100) return found == 0;
  const auto memory = [](const Sample& s) { return s.memory; };
  const auto time = [](const Sample& s) { return s.seconds / s.views; };
  const double grown = mean_of_fifth(samples, 4, memory) / mean_of_fifth(samples, 1, memory) - 1.0;
  const double slower = mean_of_fifth(samples, 4, time) / mean_of_fifth(samples, 1, time) - 1.0;
  std::cout << "last fifth compared with the second: memory " << 100.0 * grown << " %, time a view " << 100.0 * slower
            << " %\n";
  return grown > 0.05 || slower > 0.10 || found == 0;
}
