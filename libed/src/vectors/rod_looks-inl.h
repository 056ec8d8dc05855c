/// First looks at rods, as look_kernel-inl.h does for ellipsoids of revolution: the result of certified_contact with
/// RodGap and one evaluation. Part of vectors/kernels-inl.h.

#pragma once

#include "contact/least_step.h"
#include "contact/rods/pair.h"
#include "contact/spheres.h"
#include "vectors/look_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

/// Rods at the time of the look.
template <bool kSpin>
struct RodPairs : Look {
  RodPairOf<Real, Real3, kSpin> rods;
  Real bending;  ///< the fastest that turning moves the surfaces
  RoundingOf<Real> hidden;
};

/// Centres of bodies at the time of the look.
struct SphereCourse {
  Real3 position, velocity;

  HWY_INLINE SphereCourse(const double* const* bodies, Real now) {
    using Number = LookBody::Number;
    static_assert(Number::velocity == 3 && Number::time == Number::rate + 1);
    Real x[6], rate, time;
    for (int k = 0; k < 6; k += 2) load_two(bodies, k, x[k], x[k + 1]);
    load_two(bodies, Number::rate, rate, time);
    velocity = {x[3], x[4], x[5]};
    position = Real3(x[0], x[1], x[2]) + (now - time) * velocity;
  }
};

template <bool kSpin>
HWY_INLINE void first_pass(const LookInput& in, int lane, LookOutput& out, RodPairs<kSpin>& p, Lanes& open) {
  const Approach<kSpin> approach(in, lane);
  RodPairOf<Real, Real3, kSpin>& rods = p.rods;
  static_cast<Look&>(p) = approach;
  rods.r = approach.r;
  rods.v = approach.v;
  const auto number = [&](int shape, int row) { return load(in.rows[shape + row], lane); };
  rods.a = number(LookInput::shape_a, RodRows::half_length);
  rods.b = number(LookInput::shape_b, RodRows::half_length);
  rods.balls = number(LookInput::shape_a, RodRows::radius) + number(LookInput::shape_b, RodRows::radius);
  Axis<kSpin> a, b;
  const Lanes in_range = turn(approach.a, p.t, a) & turn(approach.b, p.t, b);
  rods.u_a = a.u;
  rods.u_b = b.u;
  rods.du_a = a.du;
  rods.du_b = b.du;
  rods.rate_a = a.axis_rate;
  rods.rate_b = b.axis_rate;
  if constexpr (kSpin) {
    rods.e0_a = a.e0;
    rods.e0_b = b.e0;
  }
  const PairScalesOf<Real> scales = rod_scales(rods.a, rods.b, rods.rate_a, rods.rate_b, p.reach, approach.places(),
                                               approach.speed(), approach.origin(in.now));
  p.bending = scales.bending;
  p.hidden = scales.rounding(p.t);
  const Lanes clear = approach.meet & in_range & rods.clears(rods.sample(p.n), p.n, p.hidden, p.end - p.t);
  open = open & approach.meet & in_range & !clear;
  store_first(clear, approach.meet, out, lane);
}

template <bool kSpin>
HWY_INLINE void second_pass(RodPairs<kSpin>& p, int pairs, LookOutput& out, int lane) {
  const RodPairOf<Real, Real3, kSpin>& rods = p.rods;
  const Lanes looked_at{hn::FirstN(Tag(), static_cast<std::size_t>(pairs))};
  const RodPointsOf<Real> points = rods.closest_points();
  const Real3 between = rods.between(points);
  const Real distance = sqrt(between.squaredNorm());
  const Lanes solved = looked_at & (distance > kLeastRodDistance * rods.balls);
  p.n = rods.normal(points, between, distance);
  const RodSampleOf<Real> sample = rods.sample(p.n);
  const Real horizon = p.end - p.t;
  const Lanes clear_at_once = solved & rods.clears(sample, p.n, p.hidden, horizon);
  const Lanes usable = solved & (sample.g > p.hidden.gap) & !clear_at_once;

  const Real speed = sqrt(rods.v.squaredNorm()) + p.bending;
  const Real unit = p.reach / speed;
  const Real gp = rods.between_rate(points).dot(p.n);
  const Lanes approach = gp < 0;
  const auto worth_refining = [&](Real step) {
    return approach & ((-sample.g / gp - step) <= kTangentAgreement * unit);
  };
  const auto enough = [&](Real step) { return (step >= horizon) | worth_refining(step); };
  const Real tau =
      rod_step(rods, points, distance, p.n, sample.g, Real(0.0), p.hidden, p.reach, speed, horizon, enough);
  const Lanes to_the_end = usable & (tau >= horizon);
  // Worth refining, or a step that may have to be made longer: left open.
  const Lanes too_short = !approach & (tau <= kShortStep * unit);
  const Real until = p.t + tau;
  const Lanes bound = usable & !to_the_end & !worth_refining(tau) & !too_short & (until > p.t);
  const Lanes clear = clear_at_once | to_the_end | (bound & !(until < p.end));
  SecondLook{clear, bound, until, 2, p.n}.store_in(out, lane);
}

/// Looks at spheres as sphere_contact does; those that overlap are left open.
void look_spheres(const LookInput& in, int pairs, LookOutput& out) {
  const Real now = in.now;
  for (int lane = 0; lane < pairs; lane += kLanes) {
    const SphereCourse a(in.body_a + lane, now);
    const SphereCourse b(in.body_b + lane, now);
    const Real3 r = nearest_image(b.position - a.position, in.box);
    const Real3 v = b.velocity - a.velocity;
    const SpheresOf<Real> spheres(r, v, load(in.rows[LookInput::reach], lane));
    const Lanes clear = spheres.clear(now, load(in.rows[LookInput::end], lane));
    const Real tau = select(spheres.touch(), 0.0, spheres.time());
    const Real3 between = r + tau * v;
    const Real distance = sqrt(between.squaredNorm());
    const Lanes contact = (distance > 0) & !(clear | spheres.overlap());
    const Real found = select(contact, LookOutput::contact, LookOutput::open);
    store(select(clear, LookOutput::clear, found), out.rows[LookOutput::verdict], lane);
    store(now + tau, out.rows[LookOutput::time], lane);
    store(1, out.rows[LookOutput::kernel_calls], lane);
    store3({between.x() / distance, between.y() / distance, between.z() / distance}, out.rows + LookOutput::normal,
           lane);
  }
}

}  // namespace
}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
