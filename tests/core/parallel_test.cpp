// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>

#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("parallel loops visit every index once, whatever the threads and chunks") {
  for (const int threads : {-1, 1, 2, 5, 40})
    for (const std::size_t n : {std::size_t(0), std::size_t(1), std::size_t(63), std::size_t(1000)})
      for (const std::size_t chunk : {std::size_t(0), std::size_t(1), std::size_t(7), std::size_t(5000)}) {
        std::vector<std::atomic<int>> visits(n);
        parallel_for(
            n, threads, [&](std::size_t i) { ++visits[i]; }, chunk);
        std::size_t once = 0;
        for (const auto& v : visits) once += v == 1 ? 1u : 0u;
        REQUIRE(once == n);
      }
}

TEST_CASE("parallel loops in parallel loops, and in threads of their own, end with the right sums") {
  const auto sum = [](std::size_t n) {
    std::atomic<std::size_t> out{0};
    parallel_for(
        n, 3, [&](std::size_t i) { out += i; }, 8);
    return out.load();
  };
  std::atomic<int> wrong{0};
  parallel_for(
      200, 4, [&](std::size_t i) { wrong += sum(i) == i * (i - (i > 0 ? 1 : 0)) / 2 ? 0 : 1; }, 1);
  CHECK(wrong == 0);
  std::vector<std::thread> callers;
  for (int t = 0; t < 4; ++t)
    callers.emplace_back([&] {
      for (int r = 0; r < 500; ++r) wrong += sum(100) == 4950 ? 0 : 1;
    });
  for (std::thread& t : callers) t.join();
  CHECK(wrong == 0);
}

TEST_CASE("what a parallel loop throws reaches its caller, and the next loop runs") {
  for (int round = 0; round < 200; ++round) {
    std::atomic<int> done{0};
    const auto loop = [&] {
      parallel_for(
          100, 4,
          [&](std::size_t i) {
            if (i == 30) throw std::runtime_error("thirty");
            ++done;
          },
          1);
    };
    REQUIRE_THROWS_AS(loop(), std::runtime_error);
    done = 0;
    parallel_for(
        100, 4, [&](std::size_t) { ++done; }, 1);
    REQUIRE(done == 100);
  }
}

TEST_CASE("a loop uses another thread when there is one, and is done without those that sleep") {
  // Each of two indices waits for the other to begin, so that one thread alone would never end.
  for (const int pause_ms : {0, 3, 0}) {  // helpers look for work for a while, then sleep
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
    std::atomic<int> begun{0};
    parallel_for(
        2, 2,
        [&](std::size_t) {
          ++begun;
          while (begun < 2) std::this_thread::yield();
        },
        1);
    CHECK(begun == 2);
  }
}
