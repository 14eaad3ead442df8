// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Threads that are kept for the next loop: to start one takes longer than many a loop. They are started when they are
/// first asked for, one pool a process, and run until it ends. After fork() the child starts threads of its own.
///
/// A shared library that holds a pool must stay loaded. GCC sees to that (the pool is a unique symbol); with other
/// compilers, or symbols hidden, link what dlclose may unload with `-Wl,-z,nodelete`.
#pragma once

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#if defined(__unix__) || defined(__APPLE__)
#include <pthread.h>
#include <signal.h>
#define AGRISEE_POSIX_THREADS
#endif

namespace agrisee::detail {

/// Threads that help whoever has work for several. Any number of threads may ask at once, helpers too.
class ThreadPool {
 public:
  /// The one of the process. It is never destroyed: loops may run, and helpers be at work, while a process ends.
  static ThreadPool& shared() {
    static const bool forks_seen = see_forks();
    static_cast<void>(forks_seen);
    ThreadPool* pool = current().load();
    if (pool) return *pool;
    auto* mine = new ThreadPool;
    if (current().compare_exchange_strong(pool, mine)) return *mine;
    delete mine;  // another thread was first
    return *pool;
  }

  /// Calls work() on this thread and on up to `helpers` others at the same time; returns once all of these calls have.
  /// Helpers that are busy elsewhere, cannot be started or come late are done without, so the work of a call must be
  /// whatever is left to do.
  /// @param helpers at most so many others  @param work called without arguments; must not throw
  template <typename Work>
  void run(std::size_t helpers, const Work& work) {
    Job job{[](const void* w) { (*static_cast<const Work*>(w))(); }, &work, helpers, {}, {}};
    std::fegetenv(&job.arithmetic);
    post(job);
    work();
    withdraw(job);
  }

 private:
  struct Job {
    void (*call)(const void*);
    const void* work;
    std::size_t wanted;                // helpers that may still begin
    std::atomic<std::size_t> running;  // helpers that have begun and not ended
    std::fenv_t arithmetic;            // how numbers are rounded: as where the loop is
  };

  ThreadPool() = default;

  static std::atomic<ThreadPool*>& current() {
    static std::atomic<ThreadPool*> pool{nullptr};
    return pool;
  }
  /// The pool of the process that this one was forked from; known, that no leak is seen, but not to be touched:
  /// its threads are not here, its locks may never open.
  static const ThreadPool*& before_fork() {
    static const ThreadPool* pool = nullptr;
    return pool;
  }
  /// From now on a child of fork() has no pool until it needs one.
  static bool see_forks() {
#ifdef AGRISEE_POSIX_THREADS
    return ::pthread_atfork(nullptr, nullptr, [] {
             if (const ThreadPool* pool = current().exchange(nullptr)) before_fork() = pool;
           }) == 0;
#else
    return false;
#endif
  }

  void post(Job& job) {
    std::unique_lock<std::mutex> lock(mutex_);
    start(job.wanted);
    jobs_.push_back(&job);
    posts_.fetch_add(1, std::memory_order_release);
    const std::size_t awake = std::min(asleep_, job.wanted);
    lock.unlock();
    for (std::size_t i = 0; i < awake; ++i) posted_.notify_one();
  }

  /// Sees to it that there are so many helpers, or as many as can be had.
  void start(std::size_t helpers) {
    if (helpers_ >= helpers) return;
#ifdef AGRISEE_POSIX_THREADS
    sigset_t all, before;  // signals are for the threads of the application
    sigfillset(&all);
    sigdelset(&all, SIGPROF);  // profilers may look
    const bool blocked = ::pthread_sigmask(SIG_SETMASK, &all, &before) == 0;
#endif
    try {
      for (; helpers_ < helpers; ++helpers_) std::thread([this] { serve(); }).detach();
    } catch (...) {  // no more threads, or memory, to be had: those that are there do the work
    }
#ifdef AGRISEE_POSIX_THREADS
    if (blocked) ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
#endif
  }

  void withdraw(Job& job) {
    std::unique_lock<std::mutex> lock(mutex_);
    jobs_.erase(std::find(jobs_.begin(), jobs_.end(), &job));
    lock.unlock();
    const auto ended = [&] { return job.running.load(std::memory_order_acquire) == 0; };
    if (soon(ended)) return;
    lock.lock();
    ended_.wait(lock, ended);
  }

  /// What a helper does, for ever.
  void serve() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (true) {
      const auto open = std::find_if(jobs_.begin(), jobs_.end(), [](const Job* job) { return job->wanted > 0; });
      if (open != jobs_.end()) {
        Job& job = **open;
        --job.wanted;
        job.running.fetch_add(1, std::memory_order_relaxed);
        lock.unlock();
        std::fesetenv(&job.arithmetic);
        job.call(job.work);
        lock.lock();
        if (job.running.fetch_sub(1, std::memory_order_release) == 1) ended_.notify_all();  // the job may be gone now
        continue;
      }
      const std::uint64_t seen = posts_.load(std::memory_order_relaxed);
      const auto more = [&] { return posts_.load(std::memory_order_acquire) != seen; };
      if (looking_ < processors_) {  // more would only take the time of those at work
        ++looking_;
        lock.unlock();
        soon(more);
        lock.lock();
        --looking_;
      }
      ++asleep_;
      posted_.wait(lock, more);
      --asleep_;
    }
  }

  /// Whether it happens within a short while, during which this thread does not sleep but lets others go first: one
  /// that sleeps is woken 50 to 250 us late.
  template <typename Happened>
  static bool soon(const Happened& happened) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(1000);
    while (!happened()) {
      if (std::chrono::steady_clock::now() >= until) return false;
      std::this_thread::yield();
    }
    return true;
  }

  std::mutex mutex_;
  std::condition_variable posted_, ended_;
  std::vector<Job*> jobs_;
  std::atomic<std::uint64_t> posts_{0};  // jobs so far
  std::size_t helpers_ = 0, looking_ = 0, asleep_ = 0;
  const std::size_t processors_ = std::max(2u, std::thread::hardware_concurrency()) - 1;  // for helpers
};

}  // namespace agrisee::detail

#undef AGRISEE_POSIX_THREADS
