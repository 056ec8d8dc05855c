#pragma once

/// Diffusion coefficients with errors, from displacements that blocks hold.

#include "observables/block_averages.h"
#include "observables/curves.h"
#include "observables/measured.h"

#include <cstddef>

namespace ed::internal {

/// Returns the diffusion coefficient, slope / divisor, of displacements `value`. Whether there is one is decided on all
/// data; blocks then only give its error.
template <class Value>
Estimate diffusion_estimate(const BlockAverages& averages, const Gaps::Gap& gap, std::size_t group, double divisor,
                            const Reach& reach, const Value& value) {
  if (gap) return Estimate::none({*gap});
  const double longest = averages.longest_lag();
  const auto complete = [&](const Curve& c) { return !c.t.empty() && c.t.back() >= longest; };
  const Curve all = averages.curve(group, {}, value);
  if (all.t.empty()) return {};
  if (!complete(all)) return Estimate::none({MissingReason::lags_too_short});
  if (const auto missing = why_not_diffusive(all, reach)) return Estimate::none(*missing);
  return averages.with_block_error(longest, [&](const Block* block) {
    const Curve part = averages.curve(group, {block, nullptr}, value);
    // A block whose origins have not reached the longest lag would be fitted over another window.
    return complete(part) ? final_slope(part) / divisor : kNothing;
  });
}

}  // namespace ed::internal
