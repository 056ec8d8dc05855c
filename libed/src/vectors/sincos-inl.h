/// Sine and cosine of every lane, with the bits of base/sincos.h. Part of the kernels' sources.

#pragma once

#include "vectors/lanes-inl.h"

#include "base/reduced_sincos.h"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

/// Returns sine and cosine as sincos does, for |x| <= kLargestAngle.
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

}  // namespace
}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
