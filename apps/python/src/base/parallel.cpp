#include "base/parallel.h"

#include <nanobind/nanobind.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace hardbody::python {
namespace {

namespace nb = nanobind;

constexpr std::chrono::milliseconds kSignalInterval{50};

/// Ranges that threads take in order, and the exception of the first of them that failed.
class Ranges {
 public:
  Ranges(std::size_t count, std::size_t chunk) : count_(count), chunk_(chunk) {}

  /// Works on the next range; false if there is none, or the work has been stopped.
  bool work_on_next(const Work& work) {
    const std::size_t begin = next_.fetch_add(chunk_, std::memory_order_relaxed);
    if (begin >= count_ || is_stopped_.load(std::memory_order_relaxed)) return false;
    try {
      work(begin, std::min(begin + chunk_, count_));
    } catch (...) {
      fail(begin);
    }
    return true;
  }

  /// Keeps the exception that is being handled, unless one of an earlier range is there, and stops the work.
  void fail(std::size_t begin) {
    const std::scoped_lock lock(mutex_);
    if (!failure_ || begin < failed_begin_) {
      failure_ = std::current_exception();
      failed_begin_ = begin;
    }
    stop();
  }

  void stop() { is_stopped_.store(true, std::memory_order_relaxed); }

  /// Throws the exception of the first range that failed, if any; to be called when all threads are done.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  const std::size_t count_;
  const std::size_t chunk_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> is_stopped_ = false;
  std::mutex mutex_;
  std::exception_ptr failure_;
  std::size_t failed_begin_ = 0;
};

/// Returns whether a Python signal handler has raised; the exception is then set.
bool is_interrupted() {
  const nb::gil_scoped_acquire gil;
  return PyErr_CheckSignals() != 0;
}

}  // namespace

void parallel(std::size_t count, std::size_t chunk, int threads, const Work& work) {
  parallel(count, chunk, threads, std::function<Work()>([&] { return work; }));
}

void parallel(std::size_t count, std::size_t chunk, int threads, const std::function<Work()>& make) {
  Ranges ranges(count, chunk);
  bool interrupted = false;
  {
    const nb::gil_scoped_release released;
    const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(threads), (count + chunk - 1) / chunk);
    const auto work_on_all = [&] {
      try {
        const Work work = make();
        while (ranges.work_on_next(work)) {
        }
      } catch (...) {  // of make(): an exception must not leave a thread
        ranges.fail(count);
      }
    };
    std::vector<std::jthread> pool;  // joined before the GIL is acquired again
    try {
      for (std::size_t k = 1; k < helpers; ++k) pool.emplace_back(work_on_all);
    } catch (...) {
      ranges.stop();
      throw;
    }
    const Work work = make();
    auto last = std::chrono::steady_clock::now();
    while (ranges.work_on_next(work)) {
      const auto now = std::chrono::steady_clock::now();
      if (now - last < kSignalInterval) continue;
      last = now;
      interrupted = is_interrupted();
      if (interrupted) break;
    }
    if (interrupted) ranges.stop();
  }
  if (interrupted) throw nb::python_error();
  ranges.rethrow();
}

}  // namespace hardbody::python
