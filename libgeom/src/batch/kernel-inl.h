/// Dual Newton (geom/kernel/dual_newton.h) for blocks of pairs of ellipsoids, one pair to a vector lane.
///
/// Included once by each batch/kernel_*.cpp, which sets HARDBODY_BATCH_KERNELS, the function's name, and is compiled
/// for its own instruction set. All else here has internal linkage (batch/kernel.h states why).
///
/// The result of a lane does not depend on its neighbours: if some lanes need another branch, all take it, and each
/// keeps its own result.

#include "batch/iteration-inl.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace geom::kernel {
namespace {

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
