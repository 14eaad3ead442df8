// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Stops long work from another thread. A thread that makes a long call first makes a Cancellation its current one, by
/// a CancellationScope. When another thread requests that cancellation, the call throws Cancelled. Threads that the
/// call uses obey the same cancellation.
///
/// ```
/// agrisee::Cancellation stop;                       // copies share their state
/// std::thread worker([&, stop] {
///   const agrisee::CancellationScope scope(stop);   // applies to all calls that this thread makes in the scope
///   try {
///     result = agrisee::process(cloud);
///   } catch (const agrisee::Cancelled&) {
///   }
/// });
/// stop.request();                                   // from any thread or from a signal handler
/// ```
///
/// The library checks between blocks of work, at most some milliseconds apart. Without a scope a check costs one read
/// of a thread-local variable. A cancelled call leaves its arguments, and objects whose const members it called, as
/// they were; the documentation of functions that change an object says what becomes of it.
#pragma once

#include <agrisee/core/error.hpp>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <utility>

namespace agrisee {

namespace detail {
/// The flag that stops this thread's work, or null if nothing can stop it. A plain pointer with a constant initial
/// value: access needs no initialization guard.
inline thread_local const std::atomic<bool>* current_cancellation = nullptr;
}  // namespace detail

/// A request to stop that all copies share. Any thread may request or query it at any time; both only access an atomic
/// flag, so a signal handler may do so as well.
class Cancellation {
 public:
  Cancellation() : flag_(std::make_shared<std::atomic<bool>>(false)) {}
  /// Asks all present and future work in scopes of this cancellation to stop. This cannot be undone.
  void request() const noexcept { flag_->store(true, std::memory_order_relaxed); }
  /// True once request() has been called on any copy.
  bool requested() const noexcept { return flag_->load(std::memory_order_relaxed); }

 private:
  friend class CancellationScope;
  std::shared_ptr<std::atomic<bool>> flag_;
};

/// Makes a cancellation the current one of the calling thread for as long as this object lives. Scopes nest: only the
/// innermost one applies. An object must be destroyed by the thread that made it.
class CancellationScope {
 public:
  /// @param cancellation what may stop the work of this thread from here on
  explicit CancellationScope(Cancellation cancellation)
      : cancellation_(std::move(cancellation)), before_(detail::current_cancellation) {
    detail::current_cancellation = cancellation_.flag_.get();
  }
  CancellationScope(const CancellationScope&) = delete;
  CancellationScope& operator=(const CancellationScope&) = delete;
  ~CancellationScope() { detail::current_cancellation = before_; }

 private:
  Cancellation cancellation_;
  const std::atomic<bool>* before_;
};

/// True if the calling thread has a current cancellation.
inline bool cancellable() noexcept { return detail::current_cancellation != nullptr; }

/// Checks the calling thread's current cancellation. Long work calls this between blocks.
/// @throws Cancelled if the cancellation has been requested
inline void throw_if_cancelled() {
  if (detail::current_cancellation && detail::current_cancellation->load(std::memory_order_relaxed)) throw Cancelled();
}

namespace detail {

/// Replaces the thread's current cancellation for as long as this object lives: by the caller's in helper threads, or
/// by none around changes that must be completed.
class CancellationSwap {
 public:
  explicit CancellationSwap(const std::atomic<bool>* other) : before_(current_cancellation) {
    current_cancellation = other;
  }
  CancellationSwap(const CancellationSwap&) = delete;
  CancellationSwap& operator=(const CancellationSwap&) = delete;
  ~CancellationSwap() { current_cancellation = before_; }

 private:
  const std::atomic<bool>* before_;
};

/// std::sort that checks for cancellation every 16,384 comparisons.
/// @throws Cancelled; the range then holds the same items in an unspecified order
template <typename Iterator, typename Less = std::less<>>
void sort_cancellably(Iterator first, Iterator last, Less less = {}) {
  if (!cancellable()) return std::sort(first, last, less);
  std::size_t compared = 0;
  std::sort(first, last, [&](const auto& a, const auto& b) {
    if ((++compared & 0x3FFF) == 0) throw_if_cancelled();
    return less(a, b);
  });
}

}  // namespace detail
}  // namespace agrisee
