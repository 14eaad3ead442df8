// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Runs long work without holding Python's lock, such that Ctrl-C stops it, and calls Python back from it.
#pragma once

#include <functional>
#include <optional>
#include <utility>

namespace agrisee::python {

/// Number of threads to use: `requested`, or the number of processor cores if that is 0.
/// @throws ParameterError for a negative number
int threads_of(int requested);

/// Runs `work` in a thread of its own, without Python's lock, and waits for it.
///
/// The calling thread must hold the lock. It looks for signals every 10 ms: if a handler raises an exception
/// (KeyboardInterrupt for Ctrl-C), the work is cancelled (core/cancellation.hpp), and the exception is thrown once the
/// work has stopped. What `work` throws is thrown here.
void run_interruptibly(const std::function<void()>& work);

/// The same for work with a result.
template <typename F>
auto interruptible(F&& f) {
  std::optional<decltype(f())> result;
  run_interruptibly([&] { result.emplace(f()); });
  return std::move(*result);
}

/// Called by work that runs interruptibly: runs `callback` with Python's lock, on the thread that waits for the work,
/// since programs expect their functions to be called where they made the call. What it throws is thrown here.
/// @throws Cancelled if a signal has stopped the work
void call_back(const std::function<void()>& callback);

}  // namespace agrisee::python
