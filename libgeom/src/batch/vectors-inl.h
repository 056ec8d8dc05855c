#pragma once

/// Vectors of three components, each of which holds one number of every lane, and roots and inverses of such numbers,
/// for batch/kernel-inl.h. That file documents the instruction set, the linkage and what may be included.

// Instructions that the kernels do not need are not required of the processor.
#define HWY_DISABLE_PCLMUL_AES
#define HWY_DISABLE_F16C
// Highway's checks would call its library.
#undef HWY_IS_DEBUG_BUILD
#define HWY_IS_DEBUG_BUILD 0

#include <geom/kernel/records-inl.h>

#include <geom/tolerances.h>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace geom::kernel {
namespace {

using Tag = hn::ScalableTag<double>;
using Real = hn::Vec<Tag>;
using Lanes = hn::Mask<Tag>;

constexpr int kLanes = static_cast<int>(HWY_LANES(double));

struct Real3 {
  Real x, y, z;
};

/// Symmetric matrix.
struct Real6 {
  Real xx, yy, zz, yz, xz, xy;
};

/// Matrix by its columns.
struct Real33 {
  Real3 x, y, z;
};

HWY_INLINE Real constant(double x) {
  return hn::Set(Tag(), x);
}
HWY_INLINE Real3 operator+(const Real3& a, const Real3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
HWY_INLINE Real3 operator-(const Real3& a, const Real3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
HWY_INLINE Real3 operator*(Real s, const Real3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
/// Returns a + s b.
HWY_INLINE Real3 add(const Real3& a, Real s, const Real3& b) {
  return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}
/// Returns a - s b.
HWY_INLINE Real3 subtract(const Real3& a, Real s, const Real3& b) {
  return {hn::NegMulAdd(s, b.x, a.x), hn::NegMulAdd(s, b.y, a.y), hn::NegMulAdd(s, b.z, a.z)};
}
/// Returns the product component by component.
HWY_INLINE Real3 product(const Real3& a, const Real3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
HWY_INLINE Real dot(const Real3& a, const Real3& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, a.x * b.x));
}
HWY_INLINE Real3 times(const Real6& S, const Real3& v) {
  return {hn::MulAdd(S.xz, v.z, hn::MulAdd(S.xy, v.y, S.xx * v.x)),
          hn::MulAdd(S.yz, v.z, hn::MulAdd(S.yy, v.y, S.xy * v.x)),
          hn::MulAdd(S.zz, v.z, hn::MulAdd(S.yz, v.y, S.xz * v.x))};
}
HWY_INLINE Real3 times(const Real33& M, const Real3& v) {
  return add(add(v.x * M.x, v.y, M.y), v.z, M.z);
}
HWY_INLINE Real3 transposed_times(const Real33& M, const Real3& v) {
  return {dot(M.x, v), dot(M.y, v), dot(M.z, v)};
}
HWY_INLINE Real3 select(Lanes lanes, const Real3& yes, const Real3& no) {
  return {hn::IfThenElse(lanes, yes.x, no.x), hn::IfThenElse(lanes, yes.y, no.y), hn::IfThenElse(lanes, yes.z, no.z)};
}
HWY_INLINE Real flag(Lanes lanes) {
  return hn::IfThenElse(lanes, constant(1), constant(0));
}
HWY_INLINE bool any(Lanes lanes) {
  return !hn::AllFalse(Tag(), lanes);
}

// Row of a block's input or output, or of its state.
template <class Row>
HWY_INLINE Real load(const Row& row, int lane) {
  return hn::Load(Tag(), row + lane);
}
template <class Row>
HWY_INLINE Real3 load3(const Row* rows, int lane) {
  return {load(rows[0], lane), load(rows[1], lane), load(rows[2], lane)};
}

/// Loads three numbers of each record.
HWY_INLINE Real3 load_three(const double* const* records) {
  Real3 v;
  load_two(Tag(), records, 0, v.x, v.y);
  load_two(Tag(), records, 1, v.y, v.z);
  return v;
}
/// Loads nine numbers of each record as a matrix.
HWY_INLINE Real33 load_nine(const double* const* records) {
  Real33 m;
  load_two(Tag(), records, 0, m.x.x, m.x.y);
  load_two(Tag(), records, 2, m.x.z, m.y.x);
  load_two(Tag(), records, 4, m.y.y, m.y.z);
  load_two(Tag(), records, 6, m.z.x, m.z.y);
  load_two(Tag(), records, 7, m.z.y, m.z.z);
  return m;
}

template <class Row>
HWY_INLINE Real33 load33(const Row* rows, int lane) {
  return {load3(rows, lane), load3(rows + 3, lane), load3(rows + 6, lane)};
}

template <class Row>
HWY_INLINE void store(Real x, Row& row, int lane) {
  hn::Store(x, Tag(), row + lane);
}
template <class Row>
HWY_INLINE void store3(const Real3& v, Row* rows, int lane) {
  store(v.x, rows[0], lane);
  store(v.y, rows[1], lane);
  store(v.z, rows[2], lane);
}
/// Stores v and s as one record of each lane from `lane` on.
template <class Record>
HWY_INLINE void store_record(const Real3& v, Real s, Record& record, int lane) {
  hn::StoreInterleaved4(v.x, v.y, v.z, s, Tag(), record[lane]);
}

/// Square roots and their inverses.
struct Roots {
  Real a, b, inverse_a, inverse_b;
};

#if HWY_TARGET <= HWY_AVX3

/// Estimate of 1 / sqrt(x) to 14 bits, t = x times it, and p by which 1 / sqrt(x) = estimate + p estimate and sqrt(x) =
/// t + p t, to 1.4 units in the last place: with e = 1 - x estimate^2, at most 2^-13, p = (1 - e)^(-1/2) - 1, whose
/// next term, 35/128 e^4, is below 2^-53. Shorter than the processor's own roots and quotients, which wait for each
/// other.
struct RootSeries {
  Real estimate, t, p;
};

HWY_INLINE RootSeries root_series(Real x) {
  const Real estimate{_mm512_rsqrt14_pd(x.raw)};
  const Real t = x * estimate;
  const Real e = hn::NegMulAdd(t, estimate, constant(1));
  const Real p = e * hn::MulAdd(e, hn::MulAdd(e, constant(0.3125), constant(0.375)), constant(0.5));
  return {estimate, t, p};
}

HWY_INLINE Real inverse_root(Real x) {
  const RootSeries s = root_series(x);
  return hn::MulAdd(s.estimate, s.p, s.estimate);
}

HWY_INLINE Roots roots(Real a, Real b) {
  const RootSeries of_a = root_series(a);
  const RootSeries of_b = root_series(b);
  return {hn::MulAdd(of_a.t, of_a.p, of_a.t), hn::MulAdd(of_b.t, of_b.p, of_b.t),
          hn::MulAdd(of_a.estimate, of_a.p, of_a.estimate), hn::MulAdd(of_b.estimate, of_b.p, of_b.estimate)};
}

/// Returns 1 / x to 40 bits, for uses where a relative error of 1e-12 does not matter.
HWY_INLINE Real near_inverse(Real x) {
  const Real estimate{_mm512_rcp14_pd(x.raw)};
  const Real e = hn::NegMulAdd(x, estimate, constant(1));
  return hn::MulAdd(estimate, hn::MulAdd(e, e, e), estimate);
}

/// Returns 1 / |m|.
HWY_INLINE Real inverse_norm(const Real3& m) {
  return inverse_root(dot(m, m));
}

#else

HWY_INLINE Real inverse_root(Real x) {
  return constant(1) / hn::Sqrt(x);
}

HWY_INLINE Roots roots(Real a, Real b) {
  const Real root_a = hn::Sqrt(a), root_b = hn::Sqrt(b);
  const Real inverse_ab = constant(1) / (a * b);  // computed in parallel with the square roots
  return {root_a, root_b, (inverse_ab * b) * root_a, (inverse_ab * a) * root_b};
}

HWY_INLINE Real near_inverse(Real x) {
  return constant(1) / x;
}

/// Returns 1 / |m| for m that is nearly a unit vector, see inverse_sqrt_1p in geom/kernel/dual_newton.h.
HWY_INLINE Real inverse_norm(const Real3& m) {
  const Real one = constant(1);
  const Real m2 = dot(m, m);
  const Real s = m2 - one;
  const Real s2 = s * s;
  const Real low = hn::NegMulAdd(constant(0.5), s, one);
  const Real middle = hn::NegMulAdd(constant(0.3125), s, constant(0.375));
  const Real high = hn::NegMulAdd(constant(0.24609375), s, constant(0.2734375));
  const Real series = hn::MulAdd(s2, hn::MulAdd(s2, high, middle), low);
  const Lanes far = hn::Abs(s) >= constant(kInverseSqrtSeries);
  if (any(far)) return hn::IfThenElse(far, inverse_root(m2), series);
  return series;
}

#endif

}  // namespace
}  // namespace geom::kernel
HWY_AFTER_NAMESPACE();
