// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Seconds of wall time, added up.
#pragma once

#include <chrono>

namespace agrisee {

/// Adds the seconds of its own lifetime to a counter.
class Stopwatch {
 public:
  /// Starts; `seconds` has to outlive it.
  explicit Stopwatch(double& seconds) : seconds_(seconds), start_(std::chrono::steady_clock::now()) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace agrisee
