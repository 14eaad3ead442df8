// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parallel loops whose results do not depend on the number of threads.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/detail/thread_pool.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>

namespace agrisee {

/// Calls `body(begin, end)` for consecutive chunks of [0, n), on up to `threads` threads including the caller's.
///
/// A thread that becomes free takes the next chunk. `body` must write only what belongs to its own indices; then the
/// result does not depend on the order in which the chunks run. The first exception that `body` throws ends the loop
/// and is rethrown here once all threads are done. The caller's cancellation is checked before each chunk, and all
/// threads work with the caller's floating-point environment (rounding mode).
///
/// Several threads may call this at the same time. They share one pool of helper threads, which grows to the largest
/// `threads` - 1 that was asked for. If helpers are busy or cannot be started, the remaining threads do their share.
/// @param n number of indices
/// @param threads largest number of threads to use
/// @param chunk indices in a chunk (0 counts as 1); a loop with n <= chunk runs on the caller's thread alone
/// @param body called as body(begin, end)
/// @throws Cancelled; whatever `body` throws
template <typename Body>
void parallel_chunks(std::size_t n, int threads, std::size_t chunk, Body&& body) {
  chunk = std::max<std::size_t>(chunk, 1);
  const std::size_t chunks = (n + chunk - 1) / chunk;
  const std::size_t workers = std::min<std::size_t>(chunks, static_cast<std::size_t>(std::max(threads, 1)));
  if (workers <= 1) {
    for (std::size_t begin = 0; begin < n; begin += chunk) {
      throw_if_cancelled();
      body(begin, std::min(n, begin + chunk));
    }
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&, cancellation = detail::current_cancellation] {
    const detail::CancellationSwap mine(cancellation);
    try {
      for (std::size_t c = next++; c < chunks; c = next++) {
        throw_if_cancelled();
        body(c * chunk, std::min(n, (c + 1) * chunk));
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = chunks;
    }
  };
  detail::ThreadPool::shared().run(workers - 1, work);
  if (failure) std::rethrow_exception(failure);
}

/// Calls `body(i)` for every i in [0, n) on up to `threads` threads, `chunk` indices at a time; see parallel_chunks.
template <typename Body>
void parallel_for(std::size_t n, int threads, Body&& body, std::size_t chunk = 512) {
  parallel_chunks(n, threads, chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace agrisee
