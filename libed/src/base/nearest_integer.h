#pragma once

namespace ed::internal {

/// Rounds to the nearest integer, |x| < 2^51, without the function call that baseline x86-64 needs for it. Accepts one
/// number, or one in each lane of a vector.
template <class Real>
[[gnu::always_inline]] inline Real nearest_integer(Real x) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52
  return (x + kShift) - kShift;
}

}  // namespace ed::internal
