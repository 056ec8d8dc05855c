/// What certified_contact (certified_contact.h) finds with one evaluation, one pair to a vector lane. Part of
/// uniaxial_kernels-inl.h.
///
/// Lanes that need anything but the usual (a normal that needs more than kMostSteps steps or falls back, bodies that
/// touch, a contact near enough for Newton's method) are left open, and searched from the start.

#pragma once

#include "lanes-inl.h"
#include "nearest_integer.h"
#include "parabola_steps.h"
#include "reduced_sincos.h"
#include "rounding.h"
#include "sphere_window.h"
#include "support_curvature.h"

#include <ed/tolerances.h>

#include <geom/tolerances.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

/// Newton steps of a normal before its pair is left open.
constexpr int kMostSteps = 3;

// ---------------------------------------------------------------------------------------------------------------------
// Pairs in motion

/// As sincos, for |x| <= kLargestAngle.
HWY_INLINE void sincos(Real x, Real& sin, Real& cos) {
  const ReducedSinCos<Real> reduced = reduced_sincos(x);
  const auto one = hn::Set(Bits(), std::uint64_t{1});
  const auto quadrant = hn::BitCast(Bits(), reduced.shifted.v);
  const auto odd = hn::MaskFromVec(hn::BitCast(Tag(), hn::Sub(hn::Zero(Bits()), hn::And(quadrant, one))));
  const auto sin_sign = hn::BitCast(Tag(), hn::ShiftLeft<62>(hn::AndNot(one, quadrant)));
  const auto cos_sign = hn::BitCast(Tag(), hn::ShiftLeft<62>(hn::AndNot(one, hn::Add(quadrant, one))));
  const auto sign_bit = hn::SignBit(Tag());
  sin = Real(hn::Xor(hn::IfThenElse(odd, reduced.cos.v, reduced.sin.v), hn::And(sin_sign, sign_bit)));
  cos = Real(hn::Xor(hn::IfThenElse(odd, reduced.sin.v, reduced.cos.v), hn::And(cos_sign, sign_bit)));
}

template <bool kSpin>
struct SpinAxis {
  Real3 e0;
};
template <>
struct SpinAxis<false> {};

/// One body at the time of the look.
template <bool kSpin>
struct Body : SpinAxis<kSpin> {
  Shape shape;
  Real3 u, du;  ///< axis and its rate of change
  Real rate;
  Real axis_rate;  ///< AxisMotion::axis_rate
};

/// Axis and its rate of change, as `turn` in uniaxial_gauge.h. Returns the lanes whose angle is within the range of
/// sincos.
template <bool kSpin>
HWY_INLINE Lanes turn(const LookRow* rows, int lane, Real t, Body<kSpin>& body) {
  const Real3 e1 = load3(rows + LookBody::e1, lane);
  const Real3 e2 = load3(rows + LookBody::e2, lane);
  const Real dt = t - load(rows[LookBody::time], lane);
  body.rate = load(rows[LookBody::rate], lane);
  body.axis_rate = body.rate;
  if constexpr (kSpin) body.axis_rate = select(sum_of_magnitudes(e2) > 0, body.rate, 0.0);
  const Real3 du_now = body.rate * e2;
  const Lanes at_once = dt == 0;
  body.u = e1;
  body.du = du_now;
  const Real angle = body.rate * dt;
  if (!all(at_once)) {
    Real sin, cos;
    sincos(angle, sin, cos);
    body.u = select(at_once, e1, cos * e1 + sin * e2);
    body.du = select(at_once, du_now, body.rate * (cos * e2 - sin * e1));
  }
  if constexpr (kSpin) {
    body.e0 = load3(rows + LookBody::e0, lane);
    body.u = body.u + body.e0;
  }
  return abs(angle) <= kLargestAngle;
}

/// As in periodic.h.
HWY_INLINE Real nearest_image(Real d, Real box, Real inverse) {
  return d - box * nearest_integer(d * inverse);
}

/// Pairs at the time of the look.
template <bool kSpin>
struct Pairs {
  Body<kSpin> a, b;
  Real3 r, v, n;
  Real reach;
  Real turning;  ///< reach times both rates of the axes
  Real limit;    ///< UniaxialGauge::curvature_limit
  RoundingOf<Real> hidden;
  Real t;
  Real end;  ///< of the window

  HWY_INLINE Gap gap() const { return geom::internal::uniaxial_gap_of<Both>(a.shape, b.shape, r, a.u, b.u, n); }
  HWY_INLINE Real rate(const Gap& gap) const { return gap_rate(v, a.du, b.du, gap.lever, n); }
  HWY_INLINE Lanes clear(const Gap& gap) const { return clear_by_parabola(gap.g, rate(gap), limit, hidden, end - t); }
  HWY_INLINE Step step(const Gap& gap, Lanes& definite) const {
    return newton_step(a.shape, b.shape, r, a.u, b.u, n, gap, definite);
  }
};

/// As `pair_scales` in uniaxial_gauge.h.
template <bool kSpin>
HWY_INLINE PairScalesOf<Real> pair_scales(const LookInput& in, int lane, const Pairs<kSpin>& p, const Real3& velocity_a,
                                          const Real3& velocity_b) {
  const LookRow* const row_a = in.rows + LookInput::body_a;
  const LookRow* const row_b = in.rows + LookInput::body_b;
  const Real now = in.now;
  return {.size = p.reach,
          .places = sum_of_magnitudes(load3(row_a + LookBody::position, lane)) +
                    sum_of_magnitudes(load3(row_b + LookBody::position, lane)),
          .speed = sum_of_magnitudes(velocity_a) + sum_of_magnitudes(velocity_b),
          .turning = p.turning,
          .bending = load(row_a[LookBody::turning_limit], lane) * p.a.axis_rate +
                     load(row_b[LookBody::turning_limit], lane) * p.b.axis_rate,
          .limit = p.limit,
          .origin =
              larger(abs(now), larger(abs(load(row_a[LookBody::time], lane)), abs(load(row_b[LookBody::time], lane))))};
}

/// The gap at the normals that the pairs came with: settles most. `open`: those that count; then
/// those among them that a second pass may settle.
template <bool kSpin>
HWY_INLINE Pairs<kSpin> first_pass(const LookInput& in, int lane, LookOutput& out, Lanes& open) {
  const LookRow* const row_a = in.rows + LookInput::body_a;
  const LookRow* const row_b = in.rows + LookInput::body_b;
  const Real now = in.now;
  const Real box = in.box;
  const Real inverse = 1 / in.box;
  Pairs<kSpin> p;
  const auto position = [&](const LookRow* rows, const Real3& velocity) {
    return load3(rows + LookBody::position, lane) + (now - load(rows[LookBody::time], lane)) * velocity;
  };
  const Real3 velocity_a = load3(row_a + LookBody::velocity, lane);
  const Real3 velocity_b = load3(row_b + LookBody::velocity, lane);
  const Real3 d = position(row_b, velocity_b) - position(row_a, velocity_a);
  const Real3 r(nearest_image(d.x(), box, inverse), nearest_image(d.y(), box, inverse),
                nearest_image(d.z(), box, inverse));
  p.v = velocity_b - velocity_a;
  p.reach = load(in.rows[LookInput::reach], lane);
  p.n = load3(in.rows + LookInput::normal, lane);
  const WindowOf<Real> window = sphere_window(r, p.v, p.reach, now, now, load(in.rows[LookInput::end], lane));
  const Lanes meet = window.begin < window.end;
  p.t = window.begin;
  p.end = window.end;
  p.r = r + (p.t - now) * p.v;
  p.a.shape = load_shape(row_a + LookBody::shape, lane);
  p.b.shape = load_shape(row_b + LookBody::shape, lane);
  const Lanes in_range = turn<kSpin>(row_a, lane, p.t, p.a) & turn<kSpin>(row_b, lane, p.t, p.b);
  p.turning = p.reach * (p.a.axis_rate + p.b.axis_rate);
  p.limit = load(row_a[LookBody::turning_limit], lane) * (p.a.axis_rate * p.a.axis_rate) +
            load(row_b[LookBody::turning_limit], lane) * (p.b.axis_rate * p.b.axis_rate);
  p.hidden = pair_scales(in, lane, p, velocity_a, velocity_b).rounding(p.t);
  const Lanes clear = meet & in_range & p.clear(p.gap());
  open = open & meet & in_range & !clear;
  store(select(clear | !meet, LookOutput::clear, LookOutput::open), out.rows[LookOutput::verdict], lane);
  store(select(meet, 1, 0), out.rows[LookOutput::kernel_calls], lane);
  return p;
}

/// As certified_step in curvature_steps.h.
template <bool kSpin>
HWY_INLINE Real certified_step(const Pairs<kSpin>& p, const Gap& gap, Real gp, Real horizon) {
  const auto curvature_of = [&](const Body<kSpin>& body, Real x) -> SupportCurvature<kSpin, Real> {
    Real centre = 0;
    if constexpr (kSpin) centre = body.e0.dot(p.n);
    return {x, body.du.dot(p.n), body.rate, centre};
  };
  const auto a = curvature_of(p.a, gap.x[0]);
  const auto b = curvature_of(p.b, gap.x[1]);
  return step_by_parabola(gap.g, gp, p.hidden, horizon,
                          [&](Real reach) { return a.bound(p.a.shape, reach) + b.bound(p.b.shape, reach); });
}

/// Improves the normals of the first `pairs` as improve_normal in certified_contact.h does, and makes the certified
/// step.
template <bool kSpin>
HWY_INLINE void second_pass(Pairs<kSpin>& p, int pairs, LookOutput& out, int lane) {
  Lanes improving{hn::FirstN(Tag(), static_cast<std::size_t>(pairs))};
  Lanes clear = none();
  Lanes usable = none();
  Real kernel_calls = 1;
  Gap gap = p.gap();
  for (int steps = 0;; ++steps) {
    Lanes definite;
    const Step newton = p.step(gap, definite);
    usable =
        usable | (improving & definite &
                  ((newton.decrement <= kLooseDecrement * gap.g) | (newton.decrement <= kTightDecrement * p.reach)));
    // A step that would be capped leaves the pair open.
    improving = improving & !usable & definite & (newton.delta2 <= geom::kMaxNormalStep * geom::kMaxNormalStep);
    if (steps == kMostSteps || !any(improving)) break;
    const Real least = gap.g - geom::kRoundingFactor * p.reach;
    // The others stay where they are: their numbers come out the same again.
    p.n = select(improving, step_on_sphere(p.n, newton.delta), p.n);
    kernel_calls = kernel_calls + select(improving, 1, 0);
    gap = p.gap();
    improving = improving & (gap.g >= least);
    clear = clear | (improving & p.clear(gap));
    improving = improving & !clear;
  }
  usable = usable & (gap.g > p.hidden.gap);

  const Real horizon = p.end - p.t;
  const Real gp = p.rate(gap);
  const Real tau = certified_step<kSpin>(p, gap, gp, horizon);
  const Lanes to_the_end = usable & (tau >= horizon);
  const Lanes approach = gp < 0;
  // Worth refining: left open.
  const Real speed = sqrt(p.v.squaredNorm()) + p.turning;
  const Real spread = -gap.g / gp - tau;
  const Lanes worth_refining = approach & nearly_straight(gp, spread, p.reach, speed, p.limit);
  const Real until = p.t + tau;
  const Lanes bound = usable & !to_the_end & !worth_refining & (until > p.t);
  clear = clear | to_the_end | (bound & !(until < p.end));
  store(select(clear, LookOutput::clear, select(bound, LookOutput::bound, LookOutput::open)),
        out.rows[LookOutput::verdict], lane);
  store(until, out.rows[LookOutput::time], lane);
  store(kernel_calls, out.rows[LookOutput::kernel_calls], lane);
  store3(p.n, out.rows + LookOutput::normal, lane);
}

// ---------------------------------------------------------------------------------------------------------------------
// Blocks

/// Fewer pairs than this are not worth a vector's second pass.
constexpr int kFewest = kLanes / 4 + 1;

/// Pairs of several vectors moved together. They are vectors and nothing else.
template <bool kSpin>
class OpenPairs {
 public:
  HWY_INLINE int count() const { return count_; }
  HWY_INLINE int home(int k) const { return home_[k]; }
  HWY_INLINE Pairs<kSpin>& from(int k) { return pairs_[k / kLanes]; }

  HWY_INLINE void add(const Pairs<kSpin>& p, Lanes open, int lane) {
    alignas(64) double flags[kLanes];
    hn::Store(hn::IfThenElseZero(open.mask, hn::Set(Tag(), 1.0)), Tag(), flags);
    for (int k = 0; k < kLanes; ++k) {
      if (flags[k] == 0) continue;
      Pairs<kSpin>& target = pairs_[count_ / kLanes];
      if (count_ % kLanes == 0) target = p;  // valid numbers in all lanes
      copy_lane(p, k, target, count_ % kLanes);
      home_[count_++] = lane + k;
    }
  }

 private:
  static HWY_INLINE void copy_lane(const Pairs<kSpin>& from, int lane, Pairs<kSpin>& to, int to_lane) {
    constexpr unsigned kRows = sizeof(Pairs<kSpin>) / sizeof(Real);
    static_assert(sizeof(Pairs<kSpin>) == kRows * sizeof(Real));
    const char* source = reinterpret_cast<const char*>(&from) + sizeof(double) * lane;
    char* target = reinterpret_cast<char*>(&to) + sizeof(double) * to_lane;
    for (unsigned row = 0; row < kRows; ++row) {
      __builtin_memcpy(target + row * sizeof(Real), source + row * sizeof(Real), sizeof(double));
    }
  }

  Pairs<kSpin> pairs_[kBlockLooks / kLanes];
  int home_[kBlockLooks];
  int count_ = 0;
};

template <bool kSpin>
void look(const LookInput& in, int pairs, LookOutput& out) {
  // Few pairs need the second pass.
  OpenPairs<kSpin> open_pairs;
  for (int lane = 0; lane < pairs; lane += kLanes) {
    Lanes open{hn::FirstN(Tag(), static_cast<std::size_t>(pairs - lane))};
    const Pairs<kSpin> p = first_pass<kSpin>(in, lane, out, open);
    if (any(open)) open_pairs.add(p, open, lane);
  }
  for (int k = 0; open_pairs.count() - k >= kFewest; k += kLanes) {
    const int together = open_pairs.count() - k < kLanes ? open_pairs.count() - k : kLanes;
    LookOutput late;
    second_pass<kSpin>(open_pairs.from(k), together, late, 0);
    for (int lane = 0; lane < together; ++lane) {
      for (int row = 0; row < LookOutput::count; ++row) out.rows[row][open_pairs.home(k + lane)] = late.rows[row][lane];
    }
  }
}

}  // namespace
}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
