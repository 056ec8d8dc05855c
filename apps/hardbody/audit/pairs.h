#pragma once

#include "trajectory/frame.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace hardbody {

/// Distances of the pairs of bodies of a frame that are near each other, in all images of a periodic box of any form.
struct PairAudit {
  /// Least distance of the pairs that were looked at; infinite: none is near.
  double minimum_distance = std::numeric_limits<double>::infinity();
  std::size_t closest_i = 0;     ///< place in Frame::bodies
  std::size_t closest_j = 0;     ///< the same; equal to closest_i: a body and its own image
  std::uint64_t overlaps = 0;    ///< pairs that overlap by more than the tolerance
  std::uint64_t unanswered = 0;  ///< pairs whose distance query declined
  /// Reasons why pairs were left out, each once: "bodies of type A have no shape"; empty: all were looked at.
  std::vector<std::string> not_looked_at;
};

/// Looks at all pairs of bodies whose shapes are known, by `geom::distance`, in every image that they can meet. An
/// overlap of up to `tolerance` does not count.
PairAudit audit_pairs(const Frame& frame, double tolerance);

}  // namespace hardbody
