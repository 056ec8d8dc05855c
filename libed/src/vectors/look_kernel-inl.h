/// Result of certified_contact (certified.h) with one evaluation, one pair to a vector lane. Part of
/// vectors/kernels-inl.h.
///
/// Lanes that need anything but the usual (a normal that needs more than kMostSteps steps or falls back, bodies that
/// touch, a contact near enough for Newton's method) are left open, and searched from the start.

#pragma once

#include "base/nearest_integer.h"
#include "contact/parabola_steps.h"
#include "contact/rounding.h"
#include "contact/sphere_window.h"
#include "contact/support_curvature.h"
#include "vectors/lanes-inl.h"
#include "vectors/sincos-inl.h"

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

template <bool kSpin>
struct SpinAxis {
  Real3 e0;
};
template <>
struct SpinAxis<false> {};

/// Axis of a body at the time of the look.
template <bool kSpin>
struct Axis : SpinAxis<kSpin> {
  Real3 u, du;  ///< axis and its rate of change
  Real rate;
  Real axis_rate;  ///< AxisMotion::axis_rate
};

/// Body at the time of the look.
template <bool kSpin>
struct Body : Axis<kSpin> {
  Shape shape;
};

/// An AxisMotion in each lane.
template <bool kSpin>
struct Course : SpinAxis<kSpin> {
  Real3 position, velocity;
  Real3 e1, e2;
  Real rate, time;
};

template <bool kSpin>
HWY_INLINE Course<kSpin> load_course(const double* const* bodies) {
  using Number = LookBody::Number;
  static_assert(Number::e0 == 14);
  Real x[Number::e0];
  for (int k = 0; k < Number::e0; k += 2) load_two(bodies, k, x[k], x[k + 1]);
  const auto vector = [&](Number k) { return Real3(x[k], x[k + 1], x[k + 2]); };
  Course<kSpin> course;
  course.position = vector(Number::position);
  course.velocity = vector(Number::velocity);
  course.e1 = vector(Number::e1);
  course.e2 = vector(Number::e2);
  course.rate = x[Number::rate];
  course.time = x[Number::time];
  if constexpr (kSpin) course.e0 = load_three(bodies, Number::e0);
  return course;
}

/// Axis and its rate of change, as `turn` in uniaxial_gap.h. Returns the lanes whose angle is within the range of
/// sincos.
template <bool kSpin>
HWY_INLINE Lanes turn(const Course<kSpin>& course, Real t, Axis<kSpin>& body) {
  const Real3& e1 = course.e1;
  const Real3& e2 = course.e2;
  const Real dt = t - course.time;
  body.rate = course.rate;
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
    body.e0 = course.e0;
    body.u = body.u + body.e0;
  }
  return abs(angle) <= kLargestAngle;
}

/// Returns the nearest image of a coordinate as periodic.h does.
HWY_INLINE Real nearest_image(Real d, Real box, Real inverse) {
  return d - box * nearest_integer(d * inverse);
}

/// Returns the nearest image of a vector.
HWY_INLINE Real3 nearest_image(const Real3& d, double box) {
  const Real inverse = 1 / box;
  return {nearest_image(d.x(), box, inverse), nearest_image(d.y(), box, inverse), nearest_image(d.z(), box, inverse)};
}

/// Numbers of pairs that both passes need, whatever the shapes.
struct Look {
  Real3 n;      ///< normal
  Real reach;   ///< sum of both bounding radii
  Real t, end;  ///< time of the look, end of the window
};

/// Two bodies in flight, and when their bounding spheres meet.
template <bool kSpin>
struct Approach : Look {
  Course<kSpin> a, b;
  Real3 r, v;  ///< vector between the centres at t, and its rate of change
  Lanes meet;  ///< pairs whose window is not empty

  HWY_INLINE Approach(const LookInput& in, int lane)
      : a(load_course<kSpin>(in.body_a + lane)), b(load_course<kSpin>(in.body_b + lane)) {
    const Real now = in.now;
    const auto position = [&](const Course<kSpin>& course) {
      return course.position + (now - course.time) * course.velocity;
    };
    const Real3 r_now = nearest_image(position(b) - position(a), in.box);
    v = b.velocity - a.velocity;
    reach = load(in.rows[LookInput::reach], lane);
    n = load_three(in.normal + lane, 0);
    const WindowOf<Real> window = sphere_window(r_now, v, reach, now, now, load(in.rows[LookInput::end], lane));
    meet = window.begin < window.end;
    t = window.begin;
    end = window.end;
    r = r_now + (t - now) * v;
  }
  HWY_INLINE Real places() const { return sum_of_magnitudes(a.position) + sum_of_magnitudes(b.position); }
  HWY_INLINE Real speed() const { return sum_of_magnitudes(a.velocity) + sum_of_magnitudes(b.velocity); }
  HWY_INLINE Real origin(double now) const { return larger(abs(Real(now)), larger(abs(a.time), abs(b.time))); }
};

/// Writes what a first pass has found: those of `meet` that are not clear stay open.
HWY_INLINE void store_first(Lanes clear, Lanes meet, LookOutput& out, int lane) {
  store(select(clear | !meet, LookOutput::clear, LookOutput::open), out.rows[LookOutput::verdict], lane);
  store(select(meet, 1, 0), out.rows[LookOutput::kernel_calls], lane);
}

/// Results of a second pass.
struct SecondLook {
  Lanes clear;
  Lanes bound;
  Real until;  ///< end of the certified step
  Real kernel_calls;
  Real3 n;

  HWY_INLINE void store_in(LookOutput& out, int lane) const {
    store(select(clear, LookOutput::clear, select(bound, LookOutput::bound, LookOutput::open)),
          out.rows[LookOutput::verdict], lane);
    store(until, out.rows[LookOutput::time], lane);
    store(kernel_calls, out.rows[LookOutput::kernel_calls], lane);
    store3(n, out.rows + LookOutput::normal, lane);
  }
};

/// Ellipsoids of revolution at the time of the look.
template <bool kSpin>
struct Pairs : Look {
  Body<kSpin> a, b;
  Real3 r, v;
  Real surface_speed;  ///< reach times both rates of the axes
  Real limit;          ///< UniaxialSample::curvature_limit
  RoundingOf<Real> hidden;

  HWY_INLINE Gap gap() const { return geom::kernel::uniaxial_gap_of<Both>(a.shape, b.shape, r, a.u, b.u, n); }
  HWY_INLINE Real rate(const Gap& gap) const { return gap_rate(v, a.du, b.du, gap.lever, n); }
  HWY_INLINE Lanes clear(const Gap& gap) const { return clear_by_parabola(gap.g, rate(gap), limit, hidden, end - t); }
  HWY_INLINE Step step(const Gap& gap, Lanes& definite) const {
    return newton_step(a.shape, b.shape, r, a.u, b.u, n, gap, definite);
  }
};

/// Returns the scales as `pair_scales` in uniaxial_gap.h does.
template <bool kSpin>
HWY_INLINE PairScalesOf<Real> pair_scales(const LookInput& in, int lane, const Pairs<kSpin>& p,
                                          const Approach<kSpin>& approach) {
  return {.size = p.reach,
          .places = approach.places(),
          .speed = approach.speed(),
          .surface_speed = p.surface_speed,
          .bending = load(in.rows[LookInput::turning_limit_a], lane) * p.a.axis_rate +
                     load(in.rows[LookInput::turning_limit_b], lane) * p.b.axis_rate,
          .limit = p.limit,
          .origin = approach.origin(in.now)};
}

/// Makes the pairs, and evaluates the gap at the normals that they came with, which settles most. `open`: those that
/// count; then those among them that a second pass may settle.
template <bool kSpin>
HWY_INLINE void first_pass(const LookInput& in, int lane, LookOutput& out, Pairs<kSpin>& p, Lanes& open) {
  const Approach<kSpin> approach(in, lane);
  static_cast<Look&>(p) = approach;
  p.r = approach.r;
  p.v = approach.v;
  p.a.shape = load_shape(in.rows + LookInput::shape_a, lane);
  p.b.shape = load_shape(in.rows + LookInput::shape_b, lane);
  const Lanes in_range = turn(approach.a, p.t, p.a) & turn(approach.b, p.t, p.b);
  p.surface_speed = p.reach * (p.a.axis_rate + p.b.axis_rate);
  p.limit = load(in.rows[LookInput::turning_limit_a], lane) * (p.a.axis_rate * p.a.axis_rate) +
            load(in.rows[LookInput::turning_limit_b], lane) * (p.b.axis_rate * p.b.axis_rate);
  p.hidden = pair_scales(in, lane, p, approach).rounding(p.t);
  const Lanes clear = approach.meet & in_range & p.clear(p.gap());
  open = open & approach.meet & in_range & !clear;
  store_first(clear, approach.meet, out, lane);
}

/// Returns the step as certified_step in curvature_steps.h does.
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

/// Improves the normals of the first `pairs` as improve_normal in certified.h does, and makes the certified
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
  const Real speed = sqrt(p.v.squaredNorm()) + p.surface_speed;
  const Real spread = -gap.g / gp - tau;
  const Lanes worth_refining = approach & nearly_straight(gp, spread, p.reach, speed, p.limit);
  const Real until = p.t + tau;
  const Lanes bound = usable & !to_the_end & !worth_refining & (until > p.t);
  clear = clear | to_the_end | (bound & !(until < p.end));
  SecondLook{clear, bound, until, kernel_calls, p.n}.store_in(out, lane);
}

// ---------------------------------------------------------------------------------------------------------------------
// Blocks

/// Fewer pairs than this are not worth a vector's second pass.
constexpr int kFewest = kLanes / 4 + 1;

/// The pairs of a block, and which of them are open. `P`: Pairs or RodPairs.
template <class P>
class Block {
 public:
  /// A vector of pairs, those from `lane` on.
  HWY_INLINE P& from(int lane) { return pairs_[lane / kLanes]; }

  HWY_INLINE void add_open(Lanes open, int lane) {
    alignas(8) std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Tag(), open.mask, bits);
    for (unsigned left = bits[0]; left != 0; left &= left - 1) home_[count_++] = lane + __builtin_ctz(left);
  }
  HWY_INLINE int open() const { return count_; }
  HWY_INLINE int lane_of(int k) const { return home_[k]; }

  /// Some open pairs, `together` of them from the k-th on, in one vector; its other lanes hold valid numbers.
  HWY_INLINE P gather(int k, int together) const {
    alignas(64) Index lanes[kLanes] = {};
    alignas(64) Index vectors[kLanes];
    const int last = home_[k + together - 1] / kLanes;
    for (int to = 0; to < kLanes; ++to) vectors[to] = last;
    for (int to = 0; to < together; ++to) {
      lanes[to] = home_[k + to] % kLanes;
      vectors[to] = home_[k + to] / kLanes;
    }
    const auto lane_in = hn::SetTableIndices(Tag(), lanes);
    const auto vector_in = hn::Load(IndexTag(), vectors);
    const auto in_lanes = [&](const double* numbers) {
      return hn::TableLookupLanes(hn::Load(Tag(), numbers), lane_in);
    };
    P gathered;
    move(pairs_[last], gathered, [&](const double* from, const double* /*to*/) { return in_lanes(from); });
    for (int vector = static_cast<int>(vectors[0]); vector < last; ++vector) {
      const auto of_it = hn::RebindMask(Tag(), hn::Eq(vector_in, hn::Set(IndexTag(), Index{vector})));
      move(pairs_[vector], gathered, [&](const double* from, const double* to) {
        return hn::IfThenElse(of_it, in_lanes(from), hn::Load(Tag(), to));
      });
    }
    return gathered;
  }

 private:
  using Index = std::int64_t;
  using IndexTag = hn::RebindToSigned<Tag>;

  /// Every number of `to`, from the same of `source`. Pairs are vectors and nothing else.
  template <class Move>
  static HWY_INLINE void move(const P& source, P& to, const Move& moved) {
    constexpr unsigned kNumbers = sizeof(P) / sizeof(double);
    static_assert(sizeof(P) % sizeof(Real) == 0);
    const auto* const from = reinterpret_cast<const double*>(&source);
    auto* const numbers = reinterpret_cast<double*>(&to);
    for (unsigned k = 0; k < kNumbers; k += kLanes) hn::Store(moved(from + k, numbers + k), Tag(), numbers + k);
  }

  P pairs_[kBlockLooks / kLanes];
  int home_[kBlockLooks];
  int count_ = 0;
};

template <class P>
void look(const LookInput& in, int pairs, LookOutput& out) {
  Block<P> block;
  for (int lane = 0; lane < pairs; lane += kLanes) {
    Lanes open{hn::FirstN(Tag(), static_cast<std::size_t>(pairs - lane))};
    first_pass(in, lane, out, block.from(lane), open);
    block.add_open(open, lane);
  }
  // Few pairs need the second pass.
  for (int k = 0; block.open() - k >= kFewest; k += kLanes) {
    const int together = block.open() - k < kLanes ? block.open() - k : kLanes;
    LookOutput late;
    P gathered = block.gather(k, together);
    second_pass(gathered, together, late, 0);
    for (int lane = 0; lane < together; ++lane) {
      for (int row = 0; row < LookOutput::count; ++row) out.rows[row][block.lane_of(k + lane)] = late.rows[row][lane];
    }
  }
}

}  // namespace
}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
