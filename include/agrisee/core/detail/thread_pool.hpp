// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A pool of helper threads for parallel loops. Starting a thread takes longer than many loops do, so threads are kept:
/// each process has one pool, which starts threads when they are first needed and keeps them until the process ends.
/// After fork() the child process starts threads of its own.
///
/// A shared library that contains the pool must not be unloaded. GCC ensures this, because the pool is a unique symbol.
/// With other compilers, or with hidden symbols, link libraries that dlclose() might unload with `-Wl,-z,nodelete`.
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

/// Helper threads that any number of threads, helpers included, may ask for help at the same time.
class ThreadPool {
 public:
  /// The pool of this process. It is never destroyed, because loops may still run while the process exits.
  static ThreadPool& shared() {
    static const bool forks_handled = handle_forks();
    static_cast<void>(forks_handled);
    ThreadPool* pool = current().load();
    if (pool) return *pool;
    auto* mine = new ThreadPool;
    if (current().compare_exchange_strong(pool, mine)) return *mine;
    delete mine;  // another thread made the pool first
    return *pool;
  }

  /// Calls work() on this thread and on up to `helpers` others at the same time, and returns when all these calls have
  /// returned. Fewer helpers take part if they are busy, cannot be started or come too late, so each call of work() has
  /// to do whatever is still left to do.
  /// @param helpers largest number of helper threads
  /// @param work called without arguments; must not throw
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
    std::size_t wanted;                // number of helpers that may still join
    std::atomic<std::size_t> running;  // number of helpers at work
    std::fenv_t arithmetic;            // floating-point environment of the caller
  };

  ThreadPool() = default;

  static std::atomic<ThreadPool*>& current() {
    static std::atomic<ThreadPool*> pool{nullptr};
    return pool;
  }
  /// The pool of the parent process, after fork(). The child must not use it: the threads do not exist in the child,
  /// and the mutex may be locked for ever. The pointer is kept so that leak checkers do not report the pool.
  static const ThreadPool*& before_fork() {
    static const ThreadPool* pool = nullptr;
    return pool;
  }
  /// Registers a handler by which a child process starts without a pool and makes its own when it needs one.
  static bool handle_forks() {
#ifdef AGRISEE_POSIX_THREADS
    return ::pthread_atfork(nullptr, nullptr, [] {
             if (const ThreadPool* pool = current().exchange(nullptr)) before_fork() = pool;
           }) == 0;
#else
    return false;
#endif
  }

  /// Offers a job to the helpers and wakes as many as it wants.
  void post(Job& job) {
    std::unique_lock<std::mutex> lock(mutex_);
    start(job.wanted);
    jobs_.push_back(&job);
    posts_.fetch_add(1, std::memory_order_release);
    const std::size_t awake = std::min(asleep_, job.wanted);
    lock.unlock();
    for (std::size_t i = 0; i < awake; ++i) posted_.notify_one();
  }

  /// Starts threads until there are `helpers` of them, or as many as the system allows.
  void start(std::size_t helpers) {
    if (helpers_ >= helpers) return;
#ifdef AGRISEE_POSIX_THREADS
    sigset_t all, before;  // helpers block signals: the application's own threads handle them
    sigfillset(&all);
    sigdelset(&all, SIGPROF);  // needed by profilers
    const bool blocked = ::pthread_sigmask(SIG_SETMASK, &all, &before) == 0;
#endif
    try {
      for (; helpers_ < helpers; ++helpers_) std::thread([this] { serve(); }).detach();
    } catch (...) {  // no more threads or no memory: continue with the threads there are
    }
#ifdef AGRISEE_POSIX_THREADS
    if (blocked) ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
#endif
  }

  /// Lets no more helpers join a job, and waits for those at work.
  void withdraw(Job& job) {
    std::unique_lock<std::mutex> lock(mutex_);
    jobs_.erase(std::find(jobs_.begin(), jobs_.end(), &job));
    lock.unlock();
    const auto ended = [&] { return job.running.load(std::memory_order_acquire) == 0; };
    if (spin_until(ended)) return;
    lock.lock();
    ended_.wait(lock, ended);
  }

  /// The endless loop of a helper thread: take part in jobs, wait for more.
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
        if (job.running.fetch_sub(1, std::memory_order_release) == 1) ended_.notify_all();  // job may no longer exist
        continue;
      }
      const std::uint64_t seen = posts_.load(std::memory_order_relaxed);
      const auto more = [&] { return posts_.load(std::memory_order_acquire) != seen; };
      if (spinning_ < processors_) {  // more spinning threads would slow down those at work
        ++spinning_;
        lock.unlock();
        spin_until(more);
        lock.lock();
        --spinning_;
      }
      ++asleep_;
      posted_.wait(lock, more);
      --asleep_;
    }
  }

  /// Waits up to 1 ms without sleeping, since waking a thread that sleeps takes 50 to 250 us. The thread yields to
  /// others in the meantime.
  /// @return true if `happened()` became true in that time
  template <typename Happened>
  static bool spin_until(const Happened& happened) {
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
  std::atomic<std::uint64_t> posts_{0};                  // number of jobs posted so far
  std::size_t helpers_ = 0, spinning_ = 0, asleep_ = 0;  // number of helpers in all, spinning and asleep
  const std::size_t processors_ = std::max(2u, std::thread::hardware_concurrency()) - 1;  // left for helpers
};

}  // namespace agrisee::detail

#undef AGRISEE_POSIX_THREADS
