#pragma once

/// Trial of instruction sets in a run: which kernels make more collisions a second.

#include <geom/batch.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace ed::internal {

/// Alternation of two instruction sets over short slices of a run. Kernels of both give the same bits, so that only the
/// speed depends on the choice. No rule tells it in advance: on one of Intel's processors AVX2 is 6 % ahead, on another
/// AVX-512 is 5 to 20 % ahead, because the code around the kernels is slower after instructions of 512 bits.
class KernelTrial {
 public:
  static constexpr std::uint64_t kSlice = 500;  ///< collisions
  static constexpr std::size_t kSlices = 9;     ///< slices of each set

  /// `usual`: the set that the run begins with, and keeps unless the other is faster.
  KernelTrial(geom::InstructionSet usual, geom::InstructionSet other) : sets_{usual, other} {}

  /// Set that the run is to use now.
  geom::InstructionSet current() const { return over() ? sets_[faster()] : sets_[turn()]; }
  /// Number of collisions that are left of the current slice.
  std::uint64_t left() const { return kSlice - collisions_; }
  bool over() const { return taken_[1] == kSlices; }

  /// Counts collisions of the current set, at most left(), and the seconds that they took.
  void add(std::uint64_t collisions, double seconds) {
    collisions_ += collisions;
    seconds_ += seconds;
    if (collisions_ < kSlice) return;
    const std::size_t set = turn();
    times_[set][taken_[set]++] = seconds_;
    collisions_ = 0;
    seconds_ = 0;
  }

 private:
  using Times = std::array<double, kSlices>;

  std::size_t turn() const { return taken_[0] > taken_[1] ? 1 : 0; }
  /// A median, because other processes may take a slice's time.
  static double median(Times times) {
    std::nth_element(times.begin(), times.begin() + kSlices / 2, times.end());
    return times[kSlices / 2];
  }
  std::size_t faster() const { return median(times_[1]) < median(times_[0]) ? 1 : 0; }

  std::array<geom::InstructionSet, 2> sets_;
  std::array<Times, 2> times_{};        ///< seconds of each full slice
  std::array<std::size_t, 2> taken_{};  ///< number of full slices
  std::uint64_t collisions_ = 0;        ///< collisions of the current slice
  double seconds_ = 0;                  ///< time that these took
};

}  // namespace ed::internal
