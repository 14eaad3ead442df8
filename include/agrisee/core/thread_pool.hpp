// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Threads that are kept for the next loop: to start one takes longer than many a loop. They are started when they are
/// first asked for, one pool a process (a shared library that hides its symbols has its own), and ended with it.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace agrisee::detail {

/// Threads that help whoever has work for several. Any number of threads may ask at once, helpers too.
class ThreadPool {
 public:
  ThreadPool() = default;
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;
  ~ThreadPool() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopped_ = true;
    }
    posted_.notify_all();
    for (std::thread& t : threads_) t.join();
  }

  /// The one of the process.
  static ThreadPool& shared() {
    static ThreadPool pool;
    return pool;
  }

  /// Calls work() on this thread and on up to `helpers` others at the same time; returns once all of these calls have.
  /// Helpers that are busy elsewhere, cannot be started or come late are done without, so the work of a call must be
  /// whatever is left to do.
  /// @param helpers at most so many others  @param work called without arguments; must not throw
  template <typename Work>
  void run(std::size_t helpers, const Work& work) {
    Job job{[](const void* w) { (*static_cast<const Work*>(w))(); }, &work, helpers, {}};
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
  };

  void post(Job& job) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      try {
        while (threads_.size() < job.wanted) threads_.emplace_back([this] { serve(); });
      } catch (...) {  // no more threads, or memory, to be had: those that are there do the work
      }
      jobs_.push_back(&job);
      posts_.fetch_add(1, std::memory_order_release);
    }
    posted_.notify_all();
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

  /// What a helper does.
  void serve() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!stopped_) {
      const auto open = std::find_if(jobs_.begin(), jobs_.end(), [](const Job* job) { return job->wanted > 0; });
      if (open != jobs_.end()) {
        Job& job = **open;
        --job.wanted;
        job.running.fetch_add(1, std::memory_order_relaxed);
        lock.unlock();
        job.call(job.work);
        lock.lock();
        if (job.running.fetch_sub(1, std::memory_order_release) == 1) ended_.notify_all();  // the job may be gone now
        continue;
      }
      const std::uint64_t seen = posts_.load(std::memory_order_relaxed);
      const auto more = [&] { return posts_.load(std::memory_order_acquire) != seen; };
      lock.unlock();
      soon(more);
      lock.lock();
      posted_.wait(lock, [&] { return stopped_ || more(); });
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
  std::vector<std::thread> threads_;
  bool stopped_ = false;
};

}  // namespace agrisee::detail
