// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Loops over several threads whose results do not depend on how many there are.
#pragma once

#include <agrisee/core/cancellation.hpp>
#include <agrisee/core/thread_pool.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>

namespace agrisee {

/// Call `body(begin, end)` on consecutive chunks of [0, n), on up to `threads` threads (the caller's included).
///
/// Chunks are handed out as threads become free; `body` must write only what belongs to its own indices, so the result
/// does not depend on the order. The first exception thrown by `body` is rethrown here after all threads have ended.
/// Between chunks the caller's cancellation is looked at; it is that of all the threads, and so is the caller's
/// rounding of numbers. Callers on several threads share the helpers: there are as many as the largest `threads` less
/// one, and no fewer results where they are busy or cannot be started.
/// @param n how many items
/// @param threads at most so many
/// @param chunk indices a chunk (at least 1); small loops (n <= chunk) never start a thread
/// @param body called as body(begin, end)
/// @throws Cancelled; what `body` throws
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

/// Call `body(i)` for every i in [0, n) on up to `threads` threads; see parallel_chunks.
template <typename Body>
void parallel_for(std::size_t n, int threads, Body&& body, std::size_t chunk = 512) {
  parallel_chunks(n, threads, chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace agrisee
