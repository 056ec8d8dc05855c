/// Whether dilated envelopes may overlap, as DilatedEnvelopes::may_overlap decides it, one pair to a vector lane. Part
/// of vectors/kernels-inl.h.

#pragma once

#include "vectors/dilated_gap.h"
#include "vectors/lanes-inl.h"

#include <geom/tolerances.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

/// Families of bodies; spheres are rods without a length.
enum class Family { spheroids, rods, spheres };

struct Envelope {
  Shape shape;
  Real3 axis;
};

/// Addresses of NearBodys and of the envelopes of these bodies; four numbers of each are read.
struct Candidates {
  const double* near[kBlockOverlaps];
  const double* envelope[kBlockOverlaps];

  HWY_INLINE void move(int from, int to) {
    near[to] = near[from];
    envelope[to] = envelope[from];
  }
  /// Repeats the first until vectors are full.
  HWY_INLINE void fill_up(int count) {
    for (int k = count; k % kLanes != 0; ++k) move(0, k);
  }
};

/// The vector to the bodies of some lanes, and their envelopes.
struct Other {
  Real name;  ///< the body's number in the lower half
  Real3 r;
  Envelope envelope;
};

template <bool kOneKind>
HWY_INLINE Other load_other(const OverlapInput& in, const Envelope& one, const Candidates& candidates, int lane) {
  Other other;
  Real x, y, z, kind;
  load_two(candidates.near + lane, 0, other.name, x);
  load_two(candidates.near + lane, 2, y, z);
  other.r = {x, y, z};
  load_two(candidates.envelope + lane, 0, x, y);
  load_two(candidates.envelope + lane, 2, z, kind);
  other.envelope.axis = {x, y, z};
  if constexpr (kOneKind) {
    other.envelope.shape = one.shape;
  } else {
    alignas(64) std::int64_t kinds[kLanes];
    hn::Store(hn::BitCast(hn::RebindToSigned<Tag>(), kind.v), hn::RebindToSigned<Tag>(), kinds);
    alignas(64) double rows[ShapeRows::count][kLanes];
    for (int k = 0; k < kLanes; ++k) {
      for (int row = 0; row < ShapeRows::count; ++row) rows[row][k] = in.shapes[kinds[k]].numbers[row];
    }
    other.envelope.shape = load_shape(rows, 0);
  }
  return other;
}

/// Returns the rods of a body and others, whose numbers stand where those of ellipsoids do.
HWY_INLINE RodEnvelopesOf<Real, Real3> rods_of(const Envelope& a, const Other& other) {
  static_assert(int{RodRows::half_length} == int{ShapeRows::a2} && int{RodRows::radius} == int{ShapeRows::b2});
  const Envelope& b = other.envelope;
  return {a.shape.a2, b.shape.a2, a.shape.b2 + b.shape.b2, other.r, a.axis, b.axis};
}

/// Two spheres in dilated envelopes, as RodEnvelopesOf does rods of no length.
struct SphereEnvelopes {
  Real balls;  ///< sum of the radii
  Real3 r;

  HWY_INLINE Lanes apart_along_centres(Real limit) const {
    const Real r2 = r.squaredNorm();
    return r2 > (balls + limit) * sqrt(r2);
  }
  /// Returns the direction of r, that of A's axis where the centres coincide, and sets the gap along it.
  HWY_INLINE Real3 normal(const Real3& axis, Real& gap) const {
    const Real length2 = r.squaredNorm();
    const Real3 n = select(length2 > 0, (1 / sqrt(length2)) * r, axis);
    gap = n.dot(r) - balls;
    return n;
  }
};
HWY_INLINE SphereEnvelopes spheres_of(const Envelope& a, const Other& other) {
  return {a.shape.b2 + other.envelope.shape.b2, other.r};
}

/// The Newton step with its length capped, as set_step in geom/kernel/dual_newton.h. `definite`: where it is one.
HWY_INLINE Step capped_step(const Envelope& a, const Envelope& b, const Real3& r, const Real3& n, const Gap& gap,
                            Lanes& definite) {
  Step step = newton_step(a.shape, b.shape, r, a.axis, b.axis, n, gap, definite);
  const Lanes too_long = step.delta2 > geom::kMaxNormalStep * geom::kMaxNormalStep;
  if (any(too_long)) {
    step.delta = select(too_long, (geom::kMaxNormalStep / sqrt(step.delta2)) * step.delta, step.delta);
  }
  return step;
}

/// Bodies whose gap along the line of centres does not tell them apart.
template <Family kFamily>
HWY_INLINE void overlap_closely(const Envelope& a, const Other& other, Real limit, OverlapOutput& out, int lane) {
  if constexpr (kFamily != Family::spheroids) {
    Real gap;
    Real3 n;
    if constexpr (kFamily == Family::rods) {
      n = rods_of(a, other).normal(gap);
    } else {
      n = spheres_of(a, other).normal(a.axis, gap);
    }
    store3(n, out.rows + OverlapOutput::normal, lane);
    store(select(gap > limit, OverlapOutput::apart, OverlapOutput::overlapping), out.rows[OverlapOutput::verdict],
          lane);
    return;
  }
  const Envelope& b = other.envelope;
  const Real3& r = other.r;
  const Real3 cold = geom::kernel::cold_direction(a.shape, b.shape, r, a.axis, b.axis);
  const Real length2 = cold.squaredNorm();
  Real3 n = select(length2 > 0, (1 / sqrt(length2)) * cold, a.axis);
  Gap gap = geom::kernel::uniaxial_gap_of<Both>(a.shape, b.shape, r, a.axis, b.axis, n);
  Lanes apart = gap.g > limit;
  Lanes definite;
  Step step = capped_step(a, b, r, n, gap, definite);
  Lanes known = definite;
  for (int steps = 0; steps < kOverlapSteps; ++steps) {
    const Lanes going_on = known & (gap.g + step.decrement > limit) & !apart;
    if (!any(going_on)) break;
    // The others stay where they are: their numbers come out the same again.
    n = select(going_on, step_on_sphere(n, step.delta), n);
    gap = geom::kernel::uniaxial_gap_of<Both>(a.shape, b.shape, r, a.axis, b.axis, n);
    apart = apart | (going_on & (gap.g > limit));
    step = capped_step(a, b, r, n, gap, definite);
    known = known & definite;
  }
  store3(step_on_sphere(n, step.delta), out.rows + OverlapOutput::normal, lane);
  store(select(apart, OverlapOutput::apart, select(known, OverlapOutput::overlapping, OverlapOutput::open)),
        out.rows[OverlapOutput::verdict], lane);
}

/// Lanes of bodies that count and are not told apart by the gap along the line of centres, a bit each.
template <Family kFamily>
HWY_INLINE unsigned close_lanes(const OverlapInput& in, const Envelope& a, const Other& other) {
  const hn::RebindToSigned<Tag> places;
  const auto body = hn::And(hn::BitCast(places, other.name.v), hn::Set(places, std::int64_t{0xFFFFFFFF}));
  const auto none = hn::Or(hn::Eq(body, hn::Set(places, std::int64_t{in.one})),
                           hn::Lt(body, hn::Set(places, std::int64_t{in.first})));
  const Envelope& b = other.envelope;
  Lanes apart;
  if constexpr (kFamily == Family::rods) {
    apart = rods_of(a, other).apart_along_centres(Real(in.limit));
  } else if constexpr (kFamily == Family::spheres) {
    apart = spheres_of(a, other).apart_along_centres(in.limit);
  } else {
    apart = apart_along_centres(a.shape, b.shape, a.axis, b.axis, other.r, Real(in.limit));
  }
  alignas(8) std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Tag(), hn::Not(hn::Or(apart.mask, hn::RebindMask(Tag(), none))), bits);
  return bits[0];
}

template <bool kOneKind, Family kFamily>
HWY_INLINE void overlap_all(const OverlapInput& in, OverlapOutput& out) {
  const DilatedEnvelope& one = in.envelopes[in.one];
  const double* const shape = in.shapes[one.kind].numbers;
  const Envelope a{{shape[ShapeRows::a2], shape[ShapeRows::b2], shape[ShapeRows::c], shape[ShapeRows::rho]},
                   {one.axis[0], one.axis[1], one.axis[2]}};
  Candidates candidates;
  const auto* near = static_cast<const double*>(in.near);
  for (int k = 0; k < in.count; ++k, near += 4) {
    std::int32_t body;
    __builtin_memcpy(&body, near, sizeof body);
    candidates.near[k] = near;
    candidates.envelope[k] = in.envelopes[body].axis;
  }
  candidates.fill_up(in.count);
  int count = 0;
  for (int lane = 0; lane < in.count; lane += kLanes) {
    const unsigned close = close_lanes<kFamily>(in, a, load_other<kOneKind>(in, a, candidates, lane));
    // Few are left: they are moved together. Moved always and kept if it counts: no branch on what cannot be predicted.
    const int end = HWY_MIN(in.count, lane + kLanes);
    for (int k = lane; k < end; ++k) {
      candidates.move(k, count);
      out.place[count] = k;
      count += static_cast<int>((close >> static_cast<unsigned>(k - lane)) & 1U);
    }
  }
  out.count = count;
  if (count == 0) return;
  candidates.fill_up(count);
  for (int lane = 0; lane < count; lane += kLanes) {
    overlap_closely<kFamily>(a, load_other<kOneKind>(in, a, candidates, lane), in.limit, out, lane);
  }
}

template <Family kFamily>
void overlap(const OverlapInput& in, OverlapOutput& out) {
  in.one_kind ? overlap_all<true, kFamily>(in, out) : overlap_all<false, kFamily>(in, out);
}

}  // namespace
}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
