#pragma once

#include "trajectory/frame.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace hardbody {

/// Result of checking the pairs of near bodies of a frame, in all images of a periodic box of any form.
struct PairAudit {
  /// Smallest distance of the pairs tested; infinite: there are no near pairs.
  double minimum_distance = std::numeric_limits<double>::infinity();
  std::size_t closest_i = 0;     ///< index into Frame::bodies
  std::size_t closest_j = 0;     ///< index into Frame::bodies; equal to closest_i: a body and its own image
  std::uint64_t overlaps = 0;    ///< pairs that overlap by more than the tolerance
  std::uint64_t unanswered = 0;  ///< pairs whose distance query declined
  /// Reasons for which pairs were left out, each once: "bodies of type A have no shape"; empty: all were tested.
  std::vector<std::string> not_tested;
};

/// Tests all pairs of bodies whose shapes are known, by `geom::distance`, in every image that they can touch. An
/// overlap of up to `tolerance` is not counted.
PairAudit audit_pairs(const Frame& frame, double tolerance);

}  // namespace hardbody
