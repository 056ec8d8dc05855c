#pragma once

/// Work in blocks, shared by threads.

#include <geom/kernel/refuse.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace geom::scene {

/// Throws std::invalid_argument if the number of threads is below 1.
inline void check_threads(int threads) {
  if (threads < 1) kernel::refuse("Scene: threads is " + std::to_string(threads) + "; accepted: 1 or more");
}

/// Returns the number of threads for some blocks: as many as asked for, but no more than blocks, nor than a few for
/// each processor.
inline std::size_t number_of_threads(int threads, std::size_t blocks) {
  constexpr std::size_t kThreadsPerProcessor = 4;
  const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
  return std::min({static_cast<std::size_t>(threads), blocks, kThreadsPerProcessor * processors});
}

/// Calls work(first, last) for blocks of [0, count), in any order; what it does must not depend on the block. Passes on
/// the first exception, when all threads have ended.
template <class Work>
void in_blocks(std::size_t count, std::size_t block, int threads, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex failing;
  const auto run = [&] {
    const auto all = [&] {
      for (std::size_t first = 0; (first = next.fetch_add(block)) < count;) work(first, std::min(count, first + block));
    };
#ifdef __cpp_exceptions
    try {
      all();
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
      next = count;
    }
#else
    all();
#endif
  };
  {
    std::vector<std::jthread> others;
    const std::size_t blocks = (count + block - 1) / block;
    const std::size_t wanted = number_of_threads(threads, blocks);
    for (std::size_t k = 1; k < wanted; ++k) others.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace geom::scene
