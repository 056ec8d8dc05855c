#pragma once

/// Loads numbers of records anywhere in memory into vectors of one number for each lane. The kernels of both libraries
/// read bodies this way, without the stores that filling rows of numbers would cost. There must be as many records as
/// lanes, and both numbers that are loaded in each. Included by files that are each compiled for their instruction set
/// (src/batch/kernel.h states the consequences).

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace geom::kernel {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

template <class D>
HWY_INLINE void load_two(D d, const double* const* records, int number, hn::Vec<D>& first, hn::Vec<D>& second) {
  first = hn::LoadU(d, records[0] + number);
  second = hn::LoadU(d, records[0] + number + 1);
}

#else

/// Loads a number and its successor from the first of every two records, side by side.
template <class D>
HWY_INLINE hn::Vec<D> load_blocks(D d, const double* const* records, int number) {
  if constexpr (hn::MaxLanes(D()) == 2) {
    return hn::LoadU(d, records[0] + number);
  } else {
    const hn::Half<D> half;
    const auto lower = load_blocks(half, records, number);
    return hn::Combine(d, load_blocks(half, records + hn::MaxLanes(half), number), lower);
  }
}

/// Loads a number of each record, and its successor.
template <class D>
HWY_INLINE void load_two(D d, const double* const* records, int number, hn::Vec<D>& first, hn::Vec<D>& second) {
  const auto even = load_blocks(d, records, number);
  const auto odd = load_blocks(d, records + 1, number);
  first = hn::InterleaveLower(d, even, odd);
  second = hn::InterleaveUpper(d, even, odd);
}

#endif

}  // namespace
}  // namespace geom::kernel
HWY_AFTER_NAMESPACE();
