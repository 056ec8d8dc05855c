#pragma once

/// Numbers of records that stand anywhere in memory, into vectors of one number for each lane: what the kernels of both
/// libraries read bodies with, without the stores that filling rows of numbers would cost. There must be as many
/// records as lanes, and both numbers that are loaded in each. Included by files that are compiled for their
/// instruction set each (batch_kernel.h says what follows).

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

/// Of the first of every two records a number and the one after it, side by side.
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

/// A number of each record, and the one after it.
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
