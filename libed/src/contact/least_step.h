#pragma once

/// Steps of bodies that touch, or nearly, and do not approach, where the certified step is of no use.

#include "base/select.h"

namespace ed::internal {

/// Steps shorter than this, in units of size / speed, are tried to be made longer.
inline constexpr double kShortStep = 1e-7;

/// Returns the longest of some steps up to a tenth of `unit` = size / speed that `clears`, tried from the shortest on,
/// or `shortest`. The first ones may drown in rounding where longer ones see the bodies part.
template <class Clears>
double longest_clear_step(double shortest, double unit, const Clears& clears) {
  constexpr double kFirst = 1e-12;
  constexpr double kLast = 0.1;
  constexpr double kLonger = 8;
  double longest = shortest;
  double trial = larger(kFirst * unit, shortest);
  while (trial < kLast * unit) {
    if (clears(trial)) {
      longest = larger(longest, trial);
    } else if (longest > shortest) {
      break;
    }
    trial *= kLonger;
  }
  return longest;
}

}  // namespace ed::internal
