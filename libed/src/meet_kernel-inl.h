/// Whether dilated envelopes may meet, as DilatedEnvelopes::may_meet has it, one pair to a vector lane. Part of
/// uniaxial_kernels-inl.h.

#pragma once

#include "dilated_gap.h"
#include "lanes-inl.h"

#include <geom/tolerances.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

struct Envelope {
  Shape shape;
  Real3 axis;
};

HWY_INLINE Envelope the_one(const MeetingInput& in) {
  const auto shape = [&](int row) { return in.one_shape[row][0]; };
  const auto axis = [&](int k) { return in.one_axis[k][0]; };
  return {{shape(ShapeRows::a2), shape(ShapeRows::b2), shape(ShapeRows::c), shape(ShapeRows::rho)},
          {axis(0), axis(1), axis(2)}};
}

/// The Newton step with its length capped, as set_step in geom/internal/dual_newton.h. `definite`: where it is one.
HWY_INLINE Step capped_step(const Envelope& a, const Envelope& b, const Real3& r, const Real3& n, const Gap& gap,
                            Lanes& definite) {
  Step step = newton_step(a.shape, b.shape, r, a.axis, b.axis, n, gap, definite);
  const Lanes too_long = step.delta2 > geom::kMaxNormalStep * geom::kMaxNormalStep;
  if (any(too_long)) {
    step.delta = select(too_long, (geom::kMaxNormalStep / sqrt(step.delta2)) * step.delta, step.delta);
  }
  return step;
}

/// Pairs whose gap along the line of centres does not tell them apart.
HWY_INLINE void meet_closely(const MeetingInput& in, int pairs, const MeetingRow* rows, MeetingOutput& out) {
  const Envelope a = the_one(in);
  const Real limit = in.limit;
  for (int lane = 0; lane < pairs; lane += kLanes) {
    const Envelope b{load_shape(rows + MeetingInput::shape, lane), load3(rows + MeetingInput::axis, lane)};
    const Real3 r = load3(rows + MeetingInput::r, lane);
    const Real3 cold = geom::internal::cold_direction(a.shape, b.shape, r, a.axis, b.axis);
    const Real length2 = cold.squaredNorm();
    Real3 n = select(length2 > 0, (1 / sqrt(length2)) * cold, a.axis);
    Gap gap = geom::internal::uniaxial_gap_of<Both>(a.shape, b.shape, r, a.axis, b.axis, n);
    Lanes apart = gap.g > limit;
    Lanes definite;
    Step step = capped_step(a, b, r, n, gap, definite);
    Lanes known = definite;
    for (int steps = 0; steps < kMeetingSteps; ++steps) {
      const Lanes going_on = known & (gap.g + step.decrement > limit) & !apart;
      if (!any(going_on)) break;
      // The others stay where they are: their numbers come out the same again.
      n = select(going_on, step_on_sphere(n, step.delta), n);
      gap = geom::internal::uniaxial_gap_of<Both>(a.shape, b.shape, r, a.axis, b.axis, n);
      apart = apart | (going_on & (gap.g > limit));
      step = capped_step(a, b, r, n, gap, definite);
      known = known & definite;
    }
    store3(step_on_sphere(n, step.delta), out.rows + MeetingOutput::normal, lane);
    store(select(apart, MeetingOutput::apart, select(known, MeetingOutput::meet, MeetingOutput::open)),
          out.rows[MeetingOutput::verdict], lane);
  }
}

void meet(const MeetingInput& in, int pairs, MeetingOutput& out) {
  const Envelope a = the_one(in);
  // Few pairs are left: they are moved together.
  alignas(64) MeetingRow close[MeetingInput::count];
  int home[kBlockMeetings];
  int count = 0;
  for (int lane = 0; lane < pairs; lane += kLanes) {
    const Shape shape = load_shape(in.rows + MeetingInput::shape, lane);
    const Real3 axis = load3(in.rows + MeetingInput::axis, lane);
    const Lanes apart =
        apart_along_centres(a.shape, shape, a.axis, axis, load3(in.rows + MeetingInput::r, lane), Real(in.limit));
    store(select(apart, MeetingOutput::apart, MeetingOutput::open), out.rows[MeetingOutput::verdict], lane);
  }
  for (int k = 0; k < pairs; ++k) {
    // Written always and kept if it counts: no branch on what cannot be predicted.
    for (int row = 0; row < MeetingInput::count; ++row) close[row][count] = in.rows[row][k];
    home[count] = k;
    count += out.rows[MeetingOutput::verdict][k] == MeetingOutput::open ? 1 : 0;
  }
  if (count == 0) return;
  for (int k = count; k % kLanes != 0; ++k) {
    for (int row = 0; row < MeetingInput::count; ++row) close[row][k] = close[row][0];
  }
  MeetingOutput closely;
  meet_closely(in, count, close, closely);
  for (int k = 0; k < count; ++k) {
    for (int row = 0; row < MeetingOutput::count; ++row) out.rows[row][home[k]] = closely.rows[row][k];
  }
}

}  // namespace
}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
