// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Measures wall time in seconds and adds it to a counter.
#pragma once

#include <chrono>
#include <utility>

namespace agrisee {

/// Adds the seconds between its construction and its destruction to a counter.
class Stopwatch {
 public:
  /// Starts the measurement. `seconds` must outlive this object.
  explicit Stopwatch(double& seconds) : seconds_(seconds), start_(std::chrono::steady_clock::now()) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

/// Calls `f()` and adds the wall time of the call, s, to `seconds`, also if `f` throws. Returns what `f` returns, by
/// reference if it returns a reference; `f` may return void.
template <typename F>
decltype(auto) timed(double& seconds, F&& f) {
  const Stopwatch stopwatch(seconds);
  return std::forward<F>(f)();
}

}  // namespace agrisee
