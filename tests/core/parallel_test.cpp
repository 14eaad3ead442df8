// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/parallel.hpp>

#include <cfenv>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
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

#ifndef __SANITIZE_THREAD__  // which starts no threads after fork()
TEST_CASE("loops run in a child after fork, while a process ends, and a helper may end it") {
  const auto sum = [] {
    std::atomic<std::size_t> out{0};
    parallel_for(
        1000, 4, [&](std::size_t i) { out += i; }, 8);
    return out.load();
  };
#ifdef __SANITIZE_ADDRESS__
  // A thread that starts or ends holds locks of this sanitizer, which a child would inherit for ever: wait for them.
  const std::vector<int> pauses_ms{200};
#else
  const std::vector<int> pauses_ms{0, 5};  // helpers look for work, or sleep
#endif
  for (const int pause_ms : pauses_ms) {
    REQUIRE(sum() == 499500);
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
    const pid_t child = ::fork();
    if (child == 0) {
      static const auto again = sum;
      if (again() != 499500) ::_exit(2);
      std::atexit([] {
        if (again() != 499500) ::_exit(3);
      });
      const auto caller = std::this_thread::get_id();
      parallel_for(
          2, 2,
          [&](std::size_t) {
            if (std::this_thread::get_id() != caller) std::exit(0);
            std::this_thread::sleep_for(std::chrono::seconds(20));
            ::_exit(4);  // no other thread to be had
          },
          1);
    }
    REQUIRE(child > 0);
    int status = -1;
    REQUIRE(::waitpid(child, &status, 0) == child);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(sum() == 499500);
  }
}
#endif

TEST_CASE("numbers are rounded on all threads as on the caller's") {
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TONEAREST}) {
    REQUIRE(std::fesetround(mode) == 0);
    std::atomic<int> others{0};
    parallel_for(
        100, 4, [&](std::size_t) { others += std::fegetround() == mode ? 0 : 1; }, 1);
    CHECK(others == 0);
  }
}

TEST_CASE("a loop uses another thread when there is one, and is done without those that sleep") {
  // Each of two indices waits for the other to begin, for which one thread alone would wait long.
  for (const int pause_ms : {0, 3, 0}) {  // helpers look for work for a while, then sleep
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
    std::atomic<int> begun{0};
    const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    parallel_for(
        2, 2,
        [&](std::size_t) {
          ++begun;
          while (begun < 2 && std::chrono::steady_clock::now() < late) std::this_thread::yield();
        },
        1);
    CHECK(std::chrono::steady_clock::now() < late);
  }
}
