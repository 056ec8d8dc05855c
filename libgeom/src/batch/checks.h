#pragma once

/// Arguments of distance_batch: spans with their steps, and what is refused.

#include <geom/batch.h>
#include <geom/distance.h>

#include <cstddef>
#include <span>

namespace geom::kernel {

/// Input span with its step from one pair to the next: 0 if one element serves all pairs.
template <class T>
struct Input {
  const T* data;
  std::size_t stride;

  const T& operator[](std::size_t pair) const { return data[pair * stride]; }
};

/// Throws std::invalid_argument for a span of the wrong size.
[[noreturn]] void refuse_size(const char* name, std::size_t size, const char* other, std::size_t pairs);

template <class T>
Input<T> checked(const char* name, std::span<const T> span, std::size_t pairs) {
  if (span.size() != pairs && span.size() != 1) refuse_size(name, span.size(), "1", pairs);
  return {span.data(), span.size() == 1 ? std::size_t{0} : std::size_t{1}};
}

/// Throws std::invalid_argument unless there are no starts or as many as pairs.
void check_starts(const BatchOptions& options, std::size_t pairs);

/// Returns the instruction set that is used. Throws std::invalid_argument if the processor or the build lacks it.
InstructionSet chosen(InstructionSet wanted);

/// Returns the options for a pair that `distance` answers, without a start.
DistanceOptions scalar_options(const BatchOptions& options);

}  // namespace geom::kernel
