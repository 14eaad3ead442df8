// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Stopping work from another thread: whoever wants to be able to stop a call makes a Cancellation, the current one of
/// the thread that makes the call; once it is requested the call throws Cancelled. Threads that the call starts look at
/// the same one.
///
/// ```
/// agrisee::Cancellation stop;                       // shared by copying
/// std::thread worker([&, stop] {
///   const agrisee::CancellationScope scope(stop);   // for what this thread calls from here on
///   try {
///     result = agrisee::process(cloud);
///   } catch (const agrisee::Cancelled&) {
///   }
/// });
/// stop.request();                                   // from any thread, or a signal handler
/// ```
///
/// The library looks between blocks of work, some ms apart at most. Without a scope that costs a look at a thread's own
/// variable a block. What a cancelled call was given, and objects whose const members were called, are as before; for
/// what changes an object see its documentation.
#pragma once

#include <agrisee/core/error.hpp>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <utility>

namespace agrisee {

namespace detail {
/// What stops the work of this thread; null: nothing. No destructor and a constant to begin with, so that access is
/// plain.
inline thread_local const std::atomic<bool>* current_cancellation = nullptr;
}  // namespace detail

/// A wish to stop, shared by all copies. Any number of threads may ask and request at once; both only touch an atomic
/// flag, so that a signal handler may, too.
class Cancellation {
 public:
  Cancellation() : flag_(std::make_shared<std::atomic<bool>>(false)) {}
  /// Ask all work to stop that runs, or will run, in a scope of this cancellation. For good: there is no way back.
  void request() const noexcept { flag_->store(true, std::memory_order_relaxed); }
  /// Whether that was asked.
  bool requested() const noexcept { return flag_->load(std::memory_order_relaxed); }

 private:
  friend class CancellationScope;
  std::shared_ptr<std::atomic<bool>> flag_;
};

/// Makes a cancellation the calling thread's current one while it lives; the innermost scope counts. Belongs to the
/// thread that made it.
class CancellationScope {
 public:
  /// @param cancellation what stops the thread's work from here on
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

/// Whether the calling thread's work can be stopped.
inline bool cancellable() noexcept { return detail::current_cancellation != nullptr; }

/// To be called between blocks of long work.
/// @throws Cancelled when the thread's current cancellation is requested
inline void throw_if_cancelled() {
  if (detail::current_cancellation && detail::current_cancellation->load(std::memory_order_relaxed)) throw Cancelled();
}

namespace detail {

/// Puts another cancellation in place of the thread's while it lives: that of the caller in its workers, or none around
/// changes that must not be left half done.
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

/// std::sort that looks for cancellation every some ten thousand comparisons.
/// @throws Cancelled; the range then holds its items in some order
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
