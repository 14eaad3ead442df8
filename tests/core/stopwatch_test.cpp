// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/stopwatch.hpp>

#include <stdexcept>
#include <thread>
#include <type_traits>

#include "catch.hpp"

using namespace agrisee;

TEST_CASE("timed adds the time of a call, also of one that throws") {
  double seconds = 1.0;
  const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(10)); };
  timed(seconds, wait);
  CHECK(seconds >= 1.009);
  const double before = seconds;
  CHECK_THROWS_AS(timed(seconds,
                        [&] {
                          wait();
                          throw std::runtime_error("late");
                        }),
                  std::runtime_error);
  CHECK(seconds >= before + 0.009);
}

TEST_CASE("timed returns what the call returns: a value, a reference or nothing") {
  double seconds = 0.0;
  int number = 3;
  CHECK(timed(seconds, [&] { return number + 1; }) == 4);
  timed(seconds, [&]() -> int& { return number; }) = 5;
  CHECK(number == 5);
  const auto nothing = [] {};
  STATIC_REQUIRE(std::is_void<decltype(timed(seconds, nothing))>::value);
}
