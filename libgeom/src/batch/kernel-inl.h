/// Dual Newton (geom/kernel/dual_newton.h) for blocks of pairs of ellipsoids, one pair to a vector lane.
///
/// Included once by each batch/kernel_*.cpp, which sets HARDBODY_BATCH_KERNELS, the function's name, and is compiled
/// for its own instruction set. All else here has internal linkage (batch/kernel.h states why).
///
/// The result of a lane does not depend on its neighbours: if some lanes need another branch, all take it, and each
/// keeps its own result.

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

// ---------------------------------------------------------------------------------------------------------------------
// Iteration, the same for every kind of pair

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

// ---------------------------------------------------------------------------------------------------------------------
// Two ellipsoids

/// Pairs of two ellipsoids, in A's frame, where QA = diag(a^2): B's centre at r = R_A^T p_AB, R = R_A^T R_B, QB = R
/// diag(b^2) R^T.
///
/// With H = HA + HB, T = trace H and D the product of its two eigenvalues across n (the sum of its principal minors, as
/// H n = 0), the Cayley-Hamilton theorem inverts H + g I across n without a basis there:
///
///     delta = [(T + g) y - H y] / (D + g T + g^2).
struct GeneralPairs {
  using Input = GeneralInput;
  enum Row {
    r = State::common_rows,
    semi_axes_a = r + 3,
    Q_b = semi_axes_a + 3,  ///< elements in the order of Real6
    semi_axes_b = Q_b + 6,
    R = semi_axes_b + 3,  ///< column by column
    rows = R + 9,
  };

  /// Returns (QA + QB)^-1 r, up to a positive factor.
  static HWY_INLINE Real3 cold_normal(const Real3& a, const Real6& Q, const Real3& r_AB) {
    const Real xx = hn::MulAdd(a.x, a.x, Q.xx), yy = hn::MulAdd(a.y, a.y, Q.yy), zz = hn::MulAdd(a.z, a.z, Q.zz);
    const Real6 adjugate = {hn::NegMulAdd(Q.yz, Q.yz, yy * zz),   hn::NegMulAdd(Q.xz, Q.xz, xx * zz),
                            hn::NegMulAdd(Q.xy, Q.xy, xx * yy),   hn::NegMulAdd(xx, Q.yz, Q.xy * Q.xz),
                            hn::NegMulAdd(yy, Q.xz, Q.xy * Q.yz), hn::NegMulAdd(zz, Q.xy, Q.xz * Q.yz)};
    return times(adjugate, r_AB);
  }

  static HWY_INLINE void prepare(const Input& in, StateRow* state, int lane) {
    const Real33 R_WA = load_nine(in.rotation_a + lane);
    const Real33 R_WB = load_nine(in.rotation_b + lane);
    const Real3 p_AB = load_three(in.position_b + lane) - load_three(in.position_a + lane);
    const Real3 r_AB = transposed_times(R_WA, p_AB);
    const Real33 R_AB = {transposed_times(R_WA, R_WB.x), transposed_times(R_WA, R_WB.y),
                         transposed_times(R_WA, R_WB.z)};
    const Real3 a = load_three(in.semi_axes_a + lane);
    const Real3 b = load_three(in.semi_axes_b + lane);
    const Real3 u = b.x * R_AB.x, v = b.y * R_AB.y, w = b.z * R_AB.z;
    const Real6 Q = {
        hn::MulAdd(u.x, u.x, hn::MulAdd(v.x, v.x, w.x * w.x)), hn::MulAdd(u.y, u.y, hn::MulAdd(v.y, v.y, w.y * w.y)),
        hn::MulAdd(u.z, u.z, hn::MulAdd(v.z, v.z, w.z * w.z)), hn::MulAdd(u.y, u.z, hn::MulAdd(v.y, v.z, w.y * w.z)),
        hn::MulAdd(u.x, u.z, hn::MulAdd(v.x, v.z, w.x * w.z)), hn::MulAdd(u.x, u.y, hn::MulAdd(v.x, v.y, w.x * w.y))};
    store3(r_AB, state + r, lane);
    store3(a, state + semi_axes_a, lane);
    store3({Q.xx, Q.yy, Q.zz}, state + Q_b, lane);
    store3({Q.yz, Q.xz, Q.xy}, state + Q_b + 3, lane);
    store3(b, state + semi_axes_b, lane);
    store3(R_AB.x, state + R, lane);
    store3(R_AB.y, state + R + 3, lane);
    store3(R_AB.z, state + R + 6, lane);
    start_from(state, lane, transposed_times(R_WA, load_start(in, lane)), cold_normal(a, Q, r_AB),
               load(in.rows[Input::depth], lane), length_at_least(p_AB) + length_at_least(a) + length_at_least(b));
  }

  static HWY_INLINE Evaluation evaluate(const StateRow* state, int lane, const Real3& n) {
    const Real3 r_AB = load3(state + r, lane);
    const Real3 a = load3(state + semi_axes_a, lane);
    const Real3 diagonal = load3(state + Q_b, lane);
    const Real3 beside = load3(state + Q_b + 3, lane);
    const Real6 Q = {diagonal.x, diagonal.y, diagonal.z, beside.x, beside.y, beside.z};
    const Real3 a2 = product(a, a);
    const Real3 q_a = product(a2, n);
    const Real3 q_b = times(Q, n);
    const Real h2_a = dot(n, q_a), h2_b = dot(n, q_b);
    const auto [h_a, h_b, inv_a, inv_b] = roots(h2_a, h2_b);
    const Real3 s_a = inv_a * q_a;
    const Real3 s_b = inv_b * q_b;
    const Real g = (dot(n, r_AB) - h_a) - h_b;
    const Real3 y = subtract((r_AB - s_a) - s_b, g, n);

    // H = (QA - sA sA^T) / hA + (QB - sB sB^T) / hB.
    const Real3 k_a = inv_a * s_a;
    const Real3 k_b = inv_b * s_b;
    const Real6 H = {hn::NegMulAdd(k_b.x, s_b.x, hn::NegMulAdd(k_a.x, s_a.x, hn::MulAdd(inv_a, a2.x, inv_b * Q.xx))),
                     hn::NegMulAdd(k_b.y, s_b.y, hn::NegMulAdd(k_a.y, s_a.y, hn::MulAdd(inv_a, a2.y, inv_b * Q.yy))),
                     hn::NegMulAdd(k_b.z, s_b.z, hn::NegMulAdd(k_a.z, s_a.z, hn::MulAdd(inv_a, a2.z, inv_b * Q.zz))),
                     hn::NegMulAdd(k_b.y, s_b.z, hn::NegMulAdd(k_a.y, s_a.z, inv_b * Q.yz)),
                     hn::NegMulAdd(k_b.x, s_b.z, hn::NegMulAdd(k_a.x, s_a.z, inv_b * Q.xz)),
                     hn::NegMulAdd(k_b.x, s_b.y, hn::NegMulAdd(k_a.x, s_a.y, inv_b * Q.xy))};
    const Real T = H.xx + H.yy + H.zz;
    const Real D = hn::NegMulAdd(H.yz, H.yz, H.yy * H.zz) + hn::NegMulAdd(H.xz, H.xz, H.xx * H.zz) +
                   hn::NegMulAdd(H.xy, H.xy, H.xx * H.yy);
    const Real shift = lift(g, load(state[State::rho], lane), g, T, D);
    const Real inv_det = near_inverse(hn::MulAdd(shift, shift + T, D));
    return {g, inv_det * subtract((T + shift) * y, constant(1), times(H, y))};
  }

  static HWY_INLINE void finish(const Input& in, const StateRow* state, int lane, BatchOutput& out) {
    const Real one = constant(1);
    const Real3 n = load3(state + State::normal, lane);
    const Real3 a = load3(state + semi_axes_a, lane);
    const Real3 b = load3(state + semi_axes_b, lane);
    const Real33 R_AB = load33(state + R, lane);
    // Heights are computed by |diag(a) R^T n|, which loses no digits for flat bodies, unlike n.Q n.
    const Real3 m_a = product(a, n);
    const Real3 m_b = product(b, transposed_times(R_AB, n));
    const auto [h_a, h_b, inv_a, inv_b] = roots(dot(m_a, m_a), dot(m_b, m_b));
    const Real3 s_a = inv_a * product(a, m_a);
    const Real3 s_b = inv_b * times(R_AB, product(b, m_b));
    const Answer answer = kernel::finish(state, lane, {n, load3(state + r, lane), s_a, s_b, h_a, h_b}, out);
    const Real33 R_WA = load_nine(in.rotation_a + lane);
    Real3 n_W = times(R_WA, n);
    n_W = hn::NegMulAdd(constant(0.5), dot(n_W, n_W) - one, one) * n_W;  // R_WA is orthonormal to 1e-15 only
    store_answer(answer, load_three(in.position_a + lane), times(R_WA, answer.from_centre), n_W, lane, out);
  }
};

// ---------------------------------------------------------------------------------------------------------------------
// Two ellipsoids of revolution

/// Pairs of two ellipsoids of revolution, in the world frame, by the formulas of geom/kernel/uniaxial.h.
struct UniaxialPairs {
  using Input = UniaxialInput;
  enum Row {
    r = State::common_rows,
    u_a = r + 3,
    u_b = u_a + 3,
    along2_a = u_b + 3,        ///< squares of the semi-axes along the axis
    across2_a = along2_a + 1,  ///< squares of the semi-axes across it
    c_a = across2_a + 1,       ///< differences of these squares
    along2_b = c_a + 1,
    across2_b = along2_b + 1,
    c_b = across2_b + 1,
    rows = c_b + 1,
  };

  static HWY_INLINE void prepare(const Input& in, StateRow* state, int lane) {
    const Real along_a = load(in.rows[Input::along_a], lane), across_a = load(in.rows[Input::across_a], lane);
    const Real along_b = load(in.rows[Input::along_b], lane), across_b = load(in.rows[Input::across_b], lane);
    const Real3 u = load_three(in.axis_a + lane), v = load_three(in.axis_b + lane);
    const Real3 p_AB = load_three(in.position_b + lane) - load_three(in.position_a + lane);
    const Real a2 = along_a * along_a, b2_a = across_a * across_a, c = (along_a - across_a) * (along_a + across_a);
    const Real d2 = along_b * along_b, b2_b = across_b * across_b, f = (along_b - across_b) * (along_b + across_b);
    store3(p_AB, state + r, lane);
    store3(u, state + u_a, lane);
    store3(v, state + u_b, lane);
    store(a2, state[along2_a], lane);
    store(b2_a, state[across2_a], lane);
    store(c, state[c_a], lane);
    store(d2, state[along2_b], lane);
    store(b2_b, state[across2_b], lane);
    store(f, state[c_b], lane);
    // Cold start, as cold_normal in geom/kernel/uniaxial.h except for the factor b^2 + b^2, by which that one divides.
    const Real sum = b2_a + b2_b;
    const Real k = dot(u, v);
    const Real r_a = dot(p_AB, u), r_b = dot(p_AB, v);
    const Real sum_a = sum + c, sum_b = sum + f;
    const Real det = hn::NegMulAdd(c * f, k * k, sum_a * sum_b);
    const Real x_a = hn::NegMulAdd(f * k, r_b, sum_b * r_a);
    const Real x_b = hn::NegMulAdd(c * k, r_a, sum_a * r_b);
    const Real3 cold = subtract(subtract(det * p_AB, c * x_a, u), f * x_b, v);
    start_from(state, lane, load_start(in, lane), cold, load(in.rows[Input::depth], lane),
               length_at_least(p_AB) + hn::Max(along_a, across_a) + hn::Max(along_b, across_b));
  }

  static HWY_INLINE Evaluation evaluate(const StateRow* state, int lane, const Real3& n) {
    const Real3 r_AB = load3(state + r, lane);
    const Real3 u = load3(state + u_a, lane), v = load3(state + u_b, lane);
    const Real x_a = dot(u, n), x_b = dot(v, n), z = dot(r_AB, n);
    const Real3 w_a = subtract(u, x_a, n), w_b = subtract(v, x_b, n);
    const Real w2_a = dot(w_a, w_a), w2_b = dot(w_b, w_b);
    const Real b2_a = load(state[across2_a], lane), b2_b = load(state[across2_b], lane);
    const Real h2_a = hn::MulAdd(b2_a, w2_a, load(state[along2_a], lane) * (x_a * x_a));
    const Real h2_b = hn::MulAdd(b2_b, w2_b, load(state[along2_b], lane) * (x_b * x_b));
    const auto [h_a, h_b, inv_a, inv_b] = roots(h2_a, h2_b);
    const Real g = (z - h_a) - h_b;
    const Real c_inv_a = load(state[c_a], lane) * inv_a, c_inv_b = load(state[c_b], lane) * inv_b;
    const Real3 y = subtract(subtract(subtract(r_AB, z, n), c_inv_a * x_a, w_a), c_inv_b * x_b, w_b);
    const Real f_a = b2_a * inv_a, f_b = b2_b * inv_b;
    const Real e_a = c_inv_a * inv_a * f_a, e_b = c_inv_b * inv_b * f_b;
    const Real ew_a = e_a * w2_a, ew_b = e_b * w2_b;
    const Real ww = dot(w_a, w_b);
    const Real t = ew_a + ew_b;
    const Real D = hn::NegMulAdd(e_a * e_b, ww * ww, ew_a * ew_b);
    const Real sigma = lift(g, load(state[State::rho], lane), f_a + f_b + g, t, D);
    const Real inv_det = near_inverse(hn::MulAdd(sigma, sigma + t, D));
    const Real pull_a = e_a * dot(w_a, y), pull_b = e_b * dot(w_b, y);
    return {g, inv_det * subtract(subtract((sigma + t) * y, pull_a, w_a), pull_b, w_b)};
  }

  static HWY_INLINE void finish(const Input& in, const StateRow* state, int lane, BatchOutput& out) {
    const Real3 n = load3(state + State::normal, lane);
    const Real3 u = load3(state + u_a, lane), v = load3(state + u_b, lane);
    const Real x_a = dot(u, n), x_b = dot(v, n);
    const Real3 w_a = subtract(n, x_a, u), w_b = subtract(n, x_b, v);
    const Real b2_a = load(state[across2_a], lane), b2_b = load(state[across2_b], lane);
    const Real a2_x_a = load(state[along2_a], lane) * x_a, a2_x_b = load(state[along2_b], lane) * x_b;
    const auto [h_a, h_b, inv_a, inv_b] =
        roots(hn::MulAdd(b2_a, dot(w_a, w_a), a2_x_a * x_a), hn::MulAdd(b2_b, dot(w_b, w_b), a2_x_b * x_b));
    const Real3 s_a = inv_a * add(b2_a * w_a, a2_x_a, u);
    const Real3 s_b = inv_b * add(b2_b * w_b, a2_x_b, v);
    const Answer answer = kernel::finish(state, lane, {n, load3(state + r, lane), s_a, s_b, h_a, h_b}, out);
    store_answer(answer, load_three(in.position_a + lane), answer.from_centre, n, lane, out);
  }
};

template <class Pairs>
void answer(const typename Pairs::Input& in, int pairs, BatchOutput& out) {
  Block<Pairs> block(in, pairs);
  block.solve();
  block.finish(in, pairs, out);
}

}  // namespace

BatchKernels HARDBODY_BATCH_KERNELS() {
  return {answer<GeneralPairs>, answer<UniaxialPairs>};
}

}  // namespace geom::kernel
HWY_AFTER_NAMESPACE();
