#pragma once

/// Minimum and maximum by value. std::min and std::max return references, which g++ turns into branches; on random data
/// half of them are mispredicted, and they stand in the innermost loop.

namespace ed::internal {

// As std::min and std::max, also in that the first argument is returned when they do not compare (NaN).
inline double smaller(double a, double b) {
  return b < a ? b : a;
}
inline double larger(double a, double b) {
  return a < b ? b : a;
}

}  // namespace ed::internal
