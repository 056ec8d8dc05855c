#pragma once

/// Minimum and maximum by value. std::min and std::max return references, which g++ turns into branches; on random data
/// half of them are mispredicted, and they are in the innermost loop.

namespace ed::internal {

// Same results as std::min and std::max; the first argument is returned when they do not compare (NaN).
inline double smaller(double a, double b) {
  return b < a ? b : a;
}
inline double larger(double a, double b) {
  return a < b ? b : a;
}

// Functions of conditions for formulas that are written once for one pair and for one pair in each lane of a vector.
inline bool any(bool condition) {
  return condition;
}
inline bool all(bool condition) {
  return condition;
}
inline double select(bool condition, double yes, double no) {
  return condition ? yes : no;
}

}  // namespace ed::internal
