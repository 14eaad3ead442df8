// SPDX-License-Identifier: BSD-3-Clause
#include "running.hpp"

#include <agrisee/core/cancellation.hpp>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <pybind11/pybind11.h>
#include <thread>

namespace agrisee::python {
namespace {

namespace py = pybind11;

/// Work in its thread and the caller who waits for it.
class Run {
 public:
  explicit Run(const std::function<void()>& work) : work_(work), thread_([this] { do_work(); }) {}
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;
  ~Run() { thread_.join(); }

  /// Wait until the work is done; serve its callbacks and the signals meanwhile.
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!done_) {
      changed_.wait_for(lock, std::chrono::milliseconds(10), [&] { return done_ || waiting_; });
      if (done_) break;
      lock.unlock();
      {
        const py::gil_scoped_acquire python;
        if (waiting_) serve();
        if (!raised_ && PyErr_CheckSignals() != 0) {
          raised_.emplace();  // takes the exception
          stop_.request();
        }
      }
      lock.lock();
    }
  }

  /// Throw what a signal handler raised, or what the work threw. Needs Python's lock.
  void rethrow() {
    if (raised_) throw *raised_;
    if (failure_) std::rethrow_exception(failure_);
  }

  /// Run a callback on the waiting thread. One at a time; called by the working thread.
  void call(const std::function<void()>& callback) {
    std::unique_lock<std::mutex> lock(mutex_);
    callback_ = &callback;
    callback_failure_ = nullptr;
    waiting_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !waiting_; });
    if (callback_failure_) std::rethrow_exception(std::exchange(callback_failure_, nullptr));
  }

  static thread_local Run* current;  // of the working thread

 private:
  void do_work() {
    current = this;
    const CancellationScope scope(stop_);
    try {
      work_();
    } catch (...) {
      failure_ = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    done_ = true;
    changed_.notify_all();
  }

  void serve() {
    std::exception_ptr failure;
    try {
      if (stop_.requested()) throw Cancelled();
      (*callback_)();
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    callback_failure_ = failure;
    waiting_ = false;
    changed_.notify_all();
  }

  const std::function<void()>& work_;
  Cancellation stop_;
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* callback_ = nullptr;
  bool done_ = false;
  std::atomic<bool> waiting_{false};  // a callback waits to be run
  std::exception_ptr failure_, callback_failure_;
  std::optional<py::error_already_set> raised_;
  std::thread thread_;  // the last member: it starts when the others exist
};

thread_local Run* Run::current = nullptr;

}  // namespace

int threads_of(int requested) {
  check_parameter(requested >= 0, "threads", "zero or more", requested);
  return requested > 0 ? requested : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void run_interruptibly(const std::function<void()>& work) {
  std::optional<Run> run;
  {
    const py::gil_scoped_release others;
    run.emplace(work);
    run->wait();
  }
  run->rethrow();
}

void call_back(const std::function<void()>& callback) {
  if (Run::current) return Run::current->call(callback);
  const py::gil_scoped_acquire python;
  callback();
}

}  // namespace agrisee::python
