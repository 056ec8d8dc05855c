#pragma once

/// Questions to the parabolas of a pair with rods for several choices of a turning normal, of which one that answers
/// yes is enough. `any_choice(has)` returns whether has(turn) holds for the turn of some choice.

#include "base/select.h"
#include "contact/least_step.h"

#include <ed/tolerances.h>

#include <algorithm>
#include <array>

namespace ed::internal {

/// Returns a time, about `tau` or longer, up to which there is certainly no contact. `unit`: the time in which the
/// bodies move by their size. `hidden_gap`: bound of what rounding hides of the gap.
template <class AnyChoice>
double least_clear_step(double unit, double hidden_gap, bool touching, double tau, const AnyChoice& any_choice) {
  if (tau > kShortStep * unit) return tau;
  return longest_clear_step(touching ? kTouching * unit : tau, unit, [&](double trial) {
    return any_choice([&](const auto& turn) {
      // g of bodies that touch is not known: it may fall by what rounding hides.
      const double hidden = hidden_gap + trial * turn.hidden_rate();
      return turn.stays_above(touching ? -hidden : hidden_gap, trial);
    });
  });
}

/// Returns whether the gap, 0 now, is certainly positive all the time `span`, which the turns of the choices count from
/// now on. The rate does not show over times as short as the span may be: longer ones include it.
template <class AnyChoice>
bool is_clear_for(double span, double unit, double hidden_gap, const AnyChoice& any_choice) {
  constexpr std::array<double, 4> kLonger{0.0, 1e-9, 1e-6, 1e-4};
  return std::any_of(kLonger.begin(), kLonger.end(), [&](double longer) {
    const double reach = larger(span, longer * unit);
    return any_choice([&](const auto& turn) { return turn.stays_above(hidden_gap, reach); });
  });
}

}  // namespace ed::internal
