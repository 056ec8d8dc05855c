/// Numbers, conditions and vectors of three components of every lane, and what all kernels of ellipsoids of revolution
/// do with them. Part of vectors/kernels-inl.h.

#pragma once

#include "vectors/kernels.h"

#include <geom/kernel/uniaxial_pair.h>
#include <geom/tolerances.h>

#include <geom/kernel/records-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<double>;
using Bits = hn::RebindToUnsigned<Tag>;

constexpr int kLanes = static_cast<int>(HWY_LANES(double));
static_assert(kLongestVector % kLanes == 0 && kBlockLooks % kLongestVector == 0 &&
              kBlockOverlaps % kLongestVector == 0);

struct Lanes {
  hn::Mask<Tag> mask;
};
HWY_INLINE Lanes operator&(Lanes a, Lanes b) {
  return {hn::And(a.mask, b.mask)};
}
HWY_INLINE Lanes operator|(Lanes a, Lanes b) {
  return {hn::Or(a.mask, b.mask)};
}
HWY_INLINE Lanes operator!(Lanes a) {
  return {hn::Not(a.mask)};
}
HWY_INLINE bool any(Lanes a) {
  return !hn::AllFalse(Tag(), a.mask);
}
HWY_INLINE bool all(Lanes a) {
  return hn::AllTrue(Tag(), a.mask);
}
HWY_INLINE Lanes none() {
  return {hn::MaskFromVec(hn::Zero(Tag()))};
}

struct Real {
  hn::Vec<Tag> v;

  Real() = default;
  HWY_INLINE Real(double x) : v(hn::Set(Tag(), x)) {}  // a number of every lane, without a word in the formulas
  HWY_INLINE explicit Real(hn::Vec<Tag> x) : v(x) {}
};
HWY_INLINE Real operator+(Real a, Real b) {
  return Real(hn::Add(a.v, b.v));
}
HWY_INLINE Real operator-(Real a, Real b) {
  return Real(hn::Sub(a.v, b.v));
}
HWY_INLINE Real operator*(Real a, Real b) {
  return Real(hn::Mul(a.v, b.v));
}
HWY_INLINE Real operator/(Real a, Real b) {
  return Real(hn::Div(a.v, b.v));
}
HWY_INLINE Real operator-(Real a) {
  return Real(hn::Neg(a.v));
}
HWY_INLINE Real& operator-=(Real& a, Real b) {
  return a = a - b;
}
HWY_INLINE Lanes operator<(Real a, Real b) {
  return {hn::Lt(a.v, b.v)};
}
HWY_INLINE Lanes operator>(Real a, Real b) {
  return {hn::Gt(a.v, b.v)};
}
HWY_INLINE Lanes operator<=(Real a, Real b) {
  return {hn::Le(a.v, b.v)};
}
HWY_INLINE Lanes operator>=(Real a, Real b) {
  return {hn::Ge(a.v, b.v)};
}
HWY_INLINE Lanes operator==(Real a, Real b) {
  return {hn::Eq(a.v, b.v)};
}
HWY_INLINE Real select(Lanes lanes, Real yes, Real no) {
  return Real(hn::IfThenElse(lanes.mask, yes.v, no.v));
}
HWY_INLINE Real smaller(Real a, Real b) {
  return select(b < a, b, a);
}
HWY_INLINE Real larger(Real a, Real b) {
  return select(a < b, b, a);
}
HWY_INLINE Real sqrt(Real a) {
  return Real(hn::Sqrt(a.v));
}
HWY_INLINE Real abs(Real a) {
  return Real(hn::Abs(a.v));
}
HWY_INLINE Real copysign(Real magnitude, Real sign) {
  return Real(hn::CopySign(magnitude.v, sign.v));
}

/// Vector with the part of the interface of Eigen's vectors that the formulas use.
class Real3 {
 public:
  Real3() = default;
  HWY_INLINE Real3(Real x, Real y, Real z) : x_(x), y_(y), z_(z) {}

  HWY_INLINE Real x() const { return x_; }
  HWY_INLINE Real y() const { return y_; }
  HWY_INLINE Real z() const { return z_; }
  HWY_INLINE Real dot(const Real3& b) const { return x_ * b.x_ + y_ * b.y_ + z_ * b.z_; }
  HWY_INLINE Real squaredNorm() const { return dot(*this); }

 private:
  Real x_, y_, z_;
};
HWY_INLINE Real3 operator+(const Real3& a, const Real3& b) {
  return {a.x() + b.x(), a.y() + b.y(), a.z() + b.z()};
}
HWY_INLINE Real3 operator-(const Real3& a, const Real3& b) {
  return {a.x() - b.x(), a.y() - b.y(), a.z() - b.z()};
}
HWY_INLINE Real3 operator*(Real s, const Real3& a) {
  return {s * a.x(), s * a.y(), s * a.z()};
}
HWY_INLINE Real3 select(Lanes lanes, const Real3& yes, const Real3& no) {
  return {select(lanes, yes.x(), no.x()), select(lanes, yes.y(), no.y()), select(lanes, yes.z(), no.z())};
}

/// One number of A and one of B.
struct Both {
  using Scalar = Real;
  Real a, b;

  Both() = default;
  HWY_INLINE Both(Real of_a, Real of_b) : a(of_a), b(of_b) {}
  HWY_INLINE Real operator[](int i) const { return i == 0 ? a : b; }
  HWY_INLINE Both sqrt() const { return {internal::sqrt(a), internal::sqrt(b)}; }
  HWY_INLINE Real sum() const { return a + b; }
  HWY_INLINE Real prod() const { return a * b; }
};
HWY_INLINE Both operator+(Both x, Both y) {
  return {x.a + y.a, x.b + y.b};
}
HWY_INLINE Both operator-(Both x, Both y) {
  return {x.a - y.a, x.b - y.b};
}
HWY_INLINE Both operator*(Both x, Both y) {
  return {x.a * y.a, x.b * y.b};
}
HWY_INLINE Both operator*(Both x, Real y) {
  return {x.a * y, x.b * y};
}
HWY_INLINE Both operator/(double x, Both y) {
  return {x / y.a, x / y.b};
}

template <class Row>
HWY_INLINE Real load(const Row& row, int lane) {
  return Real(hn::Load(Tag(), row + lane));
}
template <class Row>
HWY_INLINE void store(Real x, Row& row, int lane) {
  hn::Store(x.v, Tag(), row + lane);
}
template <class Row>
HWY_INLINE void store3(const Real3& v, Row* rows, int lane) {
  store(v.x(), rows[0], lane);
  store(v.y(), rows[1], lane);
  store(v.z(), rows[2], lane);
}

/// A number of each record, and the one after it.
HWY_INLINE void load_two(const double* const* records, int number, Real& first, Real& second) {
  geom::kernel::load_two(Tag(), records, number, first.v, second.v);
}
/// Three numbers of each record, one after the other.
HWY_INLINE Real3 load_three(const double* const* records, int number) {
  Real x, y, z;
  load_two(records, number, x, y);
  load_two(records, number + 1, y, z);
  return {x, y, z};
}

// ---------------------------------------------------------------------------------------------------------------------
// Pairs

struct Shape {
  Real a2, b2, c, rho;
};

template <class Row>
HWY_INLINE Shape load_shape(const Row* rows, int lane) {
  return {load(rows[ShapeRows::a2], lane), load(rows[ShapeRows::b2], lane), load(rows[ShapeRows::c], lane),
          load(rows[ShapeRows::rho], lane)};
}

using Gap = geom::kernel::UniaxialSampleOf<Both>;
using Step = geom::kernel::UniaxialStepOf<Both, Real3>;

/// The Newton step, not capped. `definite`: where it is one, the matrix needing no lift.
HWY_INLINE Step newton_step(const Shape& A, const Shape& B, const Real3& r, const Real3& u_a, const Real3& u_b,
                            const Real3& n, const Gap& gap, Lanes& definite) {
  const Real floor = geom::kLeastEigenvalue * (A.rho + B.rho);
  const auto lift = [&](Real sigma, Real t1, Real D) {
    definite = geom::kernel::definite_above(floor, sigma, t1, D);
    return sigma;
  };
  return geom::kernel::uniaxial_step_of(A, B, r, u_a, u_b, n, gap, lift);
}

HWY_INLINE Real inverse_sqrt_1p(Real s) {
  const Real series = geom::kernel::inverse_sqrt_series(s);
  const Lanes near = abs(s) < geom::kInverseSqrtSeries;
  if (all(near)) return series;
  return select(near, series, 1 / sqrt(1 + s));
}

HWY_INLINE Real3 step_on_sphere(const Real3& n, const Real3& step) {
  const Real3 m = n + step;
  return inverse_sqrt_1p(m.squaredNorm() - 1) * m;
}

}  // namespace
}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
