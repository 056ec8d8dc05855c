#pragma once

/// Meetings of two spheres, in closed form, for one pair or for one in each lane of a vector.

#include <ed/tolerances.h>

#include <cmath>

namespace ed::internal {

/// Two spheres whose centres are r apart now and move at v relative to each other, `reach` the sum of their radii. They
/// touch at the first root of |r + v tau|^2 = reach^2, taken in the form without cancellation.
template <class Real>
struct SpheresOf {
  Real reach2;
  Real distance2;
  Real approach;  ///< r.v
  Real excess;    ///< |r|^2 - reach^2
  Real discriminant;

  template <class Vector>
  [[gnu::always_inline]] SpheresOf(const Vector& r, const Vector& v, Real reach)
      : reach2(reach * reach),
        distance2(r.squaredNorm()),
        approach(r.dot(v)),
        excess(distance2 - reach2),
        discriminant(approach * approach - v.squaredNorm() * excess) {}

  [[gnu::always_inline]] auto overlap() const {
    constexpr double kShare = (1 - kOverlap) * (1 - kOverlap);
    return distance2 < kShare * reach2;
  }
  [[gnu::always_inline]] auto parting() const { return !(approach < 0); }
  [[gnu::always_inline]] auto touch() const { return !(excess > 0); }
  /// Returns the time to the contact of spheres that are apart, approach and do not miss each other.
  [[gnu::always_inline]] Real time() const {
    using std::sqrt;
    return excess / (sqrt(discriminant) - approach);
  }
  /// Returns whether there is no contact in [now, end].
  [[gnu::always_inline]] auto clear(Real now, Real end) const {
    const auto apart = !overlap();
    const auto part = parting();
    const auto distant = !touch();
    const auto late = !(now + time() <= end);
    return apart & (part | (distant & ((discriminant < 0) | late)));
  }
};

}  // namespace ed::internal
