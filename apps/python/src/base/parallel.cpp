#include "base/parallel.h"

#include "base/gil.h"

#include <nanobind/nanobind.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

namespace hardbody::python {
namespace {

namespace nb = nanobind;

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSignalInterval{50};
/// Length of a thread's first range, and the times below and above which its next one is twice or half as long: slow
/// queries must not keep an interrupt waiting.
constexpr std::size_t kFirstLength = 4;
constexpr std::chrono::milliseconds kShort{10};
constexpr std::chrono::milliseconds kLong{40};

/// Ranges that threads take in order, and the exception of the first of them that failed.
class Ranges {
 public:
  Ranges(std::size_t count, std::size_t chunk) : count_(count), chunk_(chunk) {}

  /// Works on the next range; false if there is none, or the work has been stopped. `length`: that of this thread's
  /// ranges, which is adapted.
  bool work_on_next(const Work& work, std::size_t& length) {
    const std::size_t begin = next_.fetch_add(length, std::memory_order_relaxed);
    if (begin >= count_ || is_stopped_.load(std::memory_order_relaxed)) return false;
    const Clock::time_point start = Clock::now();
    try {
      work(begin, std::min(begin + length, count_));
    } catch (...) {
      fail(begin);
    }
    const Clock::duration taken = Clock::now() - start;
    if (taken < kShort) length = std::min(2 * length, chunk_);
    if (taken > kLong) length = std::max<std::size_t>(length / 2, 1);
    return true;
  }

  std::size_t first_length() const { return std::min(kFirstLength, chunk_); }

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
  const GilAcquired gil;
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
    const GilReleased released;
    const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(threads), (count + chunk - 1) / chunk);
    const auto work_on_all = [&] {
      try {
        const Work work = make();
        for (std::size_t length = ranges.first_length(); ranges.work_on_next(work, length);) {
        }
      } catch (...) {  // of make(): an exception must not leave a thread
        ranges.fail(count);
      }
    };
    std::vector<std::jthread> pool;  // joined before the GIL is acquired again
    try {
      for (std::size_t k = 1; k < helpers; ++k) pool.emplace_back(work_on_all);
    } catch (const std::system_error& error) {
      ranges.stop();
      throw std::runtime_error("threads: the system refused thread " + std::to_string(pool.size() + 2) + " of " +
                               std::to_string(helpers) + ": " + error.code().message() +
                               "; accepted: as many as it grants");
    } catch (...) {
      ranges.stop();
      throw;
    }
    const Work work = make();
    auto last = Clock::now();
    for (std::size_t length = ranges.first_length(); ranges.work_on_next(work, length);) {
      const auto now = Clock::now();
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
