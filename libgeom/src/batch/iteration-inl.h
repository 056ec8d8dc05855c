#pragma once

/// Iteration of the batch kernels (batch/kernel-inl.h), the same for every kind of pair. That file documents the
/// instruction set, the linkage and what may be included.

#include "batch/kernel.h"
#include "batch/vectors-inl.h"

#include <geom/tolerances.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace geom::kernel {
namespace {

static_assert(kLongestVector % kLanes == 0 && kBlockPairs % kLongestVector == 0);

/// Number of evaluations before a pair is left to `distance`: few need more.
constexpr int kMostRounds = 24;
static_assert(kMostRounds % 2 == 0, "the last normals are then in the first of their rows");

/// Row of one number of each pair during the iteration.
using StateRow = double[kBlockPairs];

/// Rows that every kind of pair has.
struct State {
  enum Row {
    rho = 0,        ///< certified depth
    rounding = 1,   ///< kRoundingFactor * size
    g = 2,          ///< g at the last normal from which a step was made
    active = 3,     ///< 1: the iteration continues
    converged = 4,  ///< 1: the normal is the answer
    iterations = 5,
    normal = 6,        ///< normal to evaluate in even rounds, previous one in odd rounds
    older_normal = 9,  ///< normal to evaluate in odd rounds, previous one in even rounds
    common_rows = 12,  ///< number of rows above; further rows depend on the kind of pair
  };
};

struct Evaluation {
  Real g;
  Real3 step;  ///< Newton's step before it is capped
};

/// Returns the lift of eigenvalues if H + g I is not definite enough, by the rule of evaluate_uniaxial in
/// geom/kernel/uniaxial.h. The eigenvalues are `shift + t / 2 +- sqrt(t^2 / 4 - D)`.
HWY_INLINE Real lift(Real g, Real rho, Real shift, Real t, Real D) {
  const Real zero = constant(0), half = constant(0.5);
  const Real least = rho * hn::IfThenElse(g > hn::Neg(rho), constant(kLeastEigenvalue), half);
  const Real q = shift - least;
  const Lanes definite = hn::And(hn::MulAdd(q, q + t, D) >= zero, hn::MulAdd(half, t, q) >= zero);
  if (hn::AllTrue(Tag(), definite)) return shift;
  const Real half_t = half * t;
  const Real smallest = shift + half_t - hn::Sqrt(hn::Max(zero, hn::MulSub(half_t, half_t, D)));
  return hn::IfThenElse(definite, shift, shift + hn::Max(zero, least - smallest));
}

/// Sets the first normal: `start` if it is usable (as in solve_dual), else `cold`; any lengths.
HWY_INLINE void start_from(StateRow* rows, int lane, const Real3& start, Real3 cold, Real rho, Real size) {
  const Real least2 = constant(kLeastStart2), most2 = constant(1e300);
  const Real start2 = dot(start, start);
  const Lanes warm = hn::And(start2 > least2, start2 < most2);
  if (any(warm)) cold = select(warm, start, cold);
  const Real n2 = dot(cold, cold);
  const Real3 n = inverse_root(n2) * cold;
  store(rho, rows[State::rho], lane);
  store(constant(kRoundingFactor) * size, rows[State::rounding], lane);
  store(constant(-1e308), rows[State::g], lane);
  store(flag(hn::And(n2 > least2, n2 < most2)), rows[State::active], lane);
  store(constant(0), rows[State::converged], lane);
  store(constant(0), rows[State::iterations], lane);
  store3(n, rows + State::normal, lane);
  store3(n, rows + State::older_normal, lane);
}

template <class Input>
HWY_INLINE Real3 load_start(const Input& in, int lane) {
  if (in.has_starts) return load_three(in.start + lane);
  return {constant(0), constant(0), constant(0)};
}

/// Returns |r| without a root, at most a factor of sqrt(3) too small: tolerances relative to it are then stricter.
HWY_INLINE Real length_at_least(const Real3& r) {
  return hn::Max(hn::Max(hn::Abs(r.x), hn::Abs(r.y)), hn::Abs(r.z));
}

/// Evaluates the pairs from `lane` on and moves their normals: by a Newton step, or back if g fell (`ascend` and
/// `backtrack` of geom/kernel/dual_newton.h). Returns whether some of them continue.
template <class Pairs>
HWY_INLINE bool advance(StateRow* rows, int lane, int round) {
  const Real one = constant(1), zero = constant(0);
  StateRow* const row_n = rows + (round % 2 == 0 ? State::normal : State::older_normal);
  StateRow* const row_previous = rows + (round % 2 == 0 ? State::older_normal : State::normal);
  const Real3 n = load3(row_n, lane);
  const Evaluation e = Pairs::evaluate(rows, lane, n);
  const Real step2 = dot(e.step, e.step);
  Real3 step = e.step;
  const Lanes too_long = step2 > constant(kMaxNormalStep * kMaxNormalStep);
  if (any(too_long)) {
    step = hn::IfThenElse(too_long, constant(kMaxNormalStep) * inverse_root(step2), one) * step;
  }
  Real3 from = n;
  Real g = e.g;
  const Lanes active = load(rows[State::active], lane) > zero;
  const Real g_before = load(rows[State::g], lane);
  const Lanes fell = hn::And(active, g < g_before - load(rows[State::rounding], lane));
  if (any(fell)) {
    // The step that lowered g, from its two ends.
    const Real3 previous = load3(row_previous, lane);
    const Real3 fallen = (one / dot(n, previous)) * n - previous;
    from = select(fell, previous, from);
    step = select(fell, constant(kBacktrack) * fallen, step);
    g = hn::IfThenElse(fell, g_before, g);
    store3(from, row_n, lane);
  }
  const Real3 m = from + step;
  const Real3 next = inverse_norm(m) * m;

  // NaN compares false: a pair whose numbers overflow is neither converged nor does it continue.
  const Real tolerance = constant(kNormalTolerance2);
  const Lanes converged = hn::AndNot(fell, hn::And(active, step2 <= tolerance));
  const Lanes goes_on = hn::And(active, hn::Or(fell, hn::And(step2 > tolerance, step2 < constant(1e300))));
  const Real3 kept = select(hn::Or(converged, goes_on), next, n);
  store3(kept, row_previous, lane);
  store(g, rows[State::g], lane);
  store(flag(goes_on), rows[State::active], lane);
  store(load(rows[State::converged], lane) + flag(converged), rows[State::converged], lane);
  store(load(rows[State::iterations], lane) + flag(active), rows[State::iterations], lane);
  const bool some_go_on = any(goes_on);
  if (!some_go_on) store3(kept, row_n, lane);  // done: both rows hold it
  return some_go_on;
}

/// Answer at a normal, as in witness_result. `s_b` is minus the support point of B at -n.
struct Witness {
  Real3 n, r, s_a, s_b;
  Real h_a, h_b;
};

struct Answer {
  Real distance;
  Real3 from_centre;  ///< vector from A's centre to the witness point on A
  Real residual;
  Real error_bound;
};

HWY_INLINE Answer finish(const StateRow* rows, int lane, const Witness& w, BatchOutput& out) {
  const Real distance = (dot(w.n, w.r) - w.h_a) - w.h_b;
  const Real3 gap = (w.r - w.s_b) - w.s_a;
  const Real3 y = subtract(gap, dot(w.n, gap), w.n);
  const Real y2 = dot(y, y);
  const Real rounding = load(rows[State::rounding], lane);
  const Real depth_left = distance + load(rows[State::rho], lane);
  const Lanes certified = depth_left > constant(0);
  const Lanes polished = y2 <= constant(kResidualTolerance / kRoundingFactor) * rounding * depth_left;
  const Lanes converged = load(rows[State::converged], lane) > constant(0);
  const Lanes answered = hn::And(converged, hn::And(certified, polished));
  store(hn::IfThenElseZero(answered, load(rows[State::iterations], lane)), out.iterations, lane);
  const Real residual = y2 * inverse_root(hn::Max(y2, constant(1e-300)));  // 0 for 0; no accepted size gives less
  const Real error_bound = constant(0.5) * y2 * near_inverse(depth_left);  // see newton_error_bound
  return {distance, add(w.s_a, constant(0.5), y), residual, error_bound};
}

HWY_INLINE void store_answer(const Answer& answer, const Real3& p_WA, const Real3& from_centre, const Real3& n,
                             int lane, BatchOutput& out) {
  const Real3 point_a = p_WA + from_centre;
  const Real3 point_b = add(point_a, answer.distance, n);
  hn::StoreInterleaved4(answer.distance, point_a.x, point_a.y, point_a.z, Tag(),
                        out.records[BatchOutput::distance_and_point_a][lane]);
  store_record(point_b, answer.residual, out.records[BatchOutput::point_b_and_residual], lane);
  store_record(n, answer.error_bound, out.records[BatchOutput::normal_and_error_bound], lane);
}

/// Block of pairs during the iteration.
template <class Pairs>
class Block {
 public:
  HWY_INLINE Block(const typename Pairs::Input& in, int pairs) {
    for (int lane = 0; lane < pairs; lane += kLanes) {
      Pairs::prepare(in, rows_, lane);
      active_[vectors_++] = lane;
    }
  }

  /// Iterates until all pairs are done. Vectors take turns, so that the processor has several independent chains of
  /// operations at a time.
  HWY_INLINE void solve() {
    for (int round = 0; round < kMostRounds && vectors_ > 0; ++round) {
      int kept = 0;
      for (int i = 0; i < vectors_; ++i) {
        if (advance<Pairs>(rows_, active_[i], round)) active_[kept++] = active_[i];
      }
      vectors_ = kept;
    }
  }

  HWY_INLINE void finish(const typename Pairs::Input& in, int pairs, BatchOutput& out) const {
    for (int lane = 0; lane < pairs; lane += kLanes) Pairs::finish(in, rows_, lane, out);
  }

 private:
  alignas(64) StateRow rows_[Pairs::rows];
  int active_[kBlockPairs / kLanes];  ///< first lanes of the vectors that continue
  int vectors_ = 0;                   ///< number of vectors that continue
};

}  // namespace
}  // namespace geom::kernel
HWY_AFTER_NAMESPACE();
